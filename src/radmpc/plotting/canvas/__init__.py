"""Figures, axes, colors, labels: what every picture is drawn on."""
