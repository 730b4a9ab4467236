"""One frame: from the world at an instant to the core's input and the arrays it fills."""
