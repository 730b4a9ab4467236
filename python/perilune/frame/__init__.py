"""One frame: from the world of an instant to what the core is asked, and the arrays it fills."""
