"""What people look at: sheets of a sample, plots, graphs of materials, notebooks."""
