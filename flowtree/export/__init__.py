"""Writes trees and skeletons into the formats of other programs."""
