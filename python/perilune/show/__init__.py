"""Visualisation: contact sheets of samples, plots, graphs of materials, notebooks."""
