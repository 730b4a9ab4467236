"""Models of spacecraft: files, parts, faces, and nodes that move."""
