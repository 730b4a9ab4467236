"""The sky: stars, catalogues, pictures of the background."""
