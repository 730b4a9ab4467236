"""What accuracy costs in a scene: its knobs, what each setting errs and takes, and advice."""
