"""Formats of datasets in folders, a file each; `table.py` lists them."""
