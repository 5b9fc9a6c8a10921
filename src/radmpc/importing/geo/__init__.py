"""Problems drawn on a map: GeoJSON and KML."""
