"""What a picture consists of, in the plane and in space."""
