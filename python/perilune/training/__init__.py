"""Batches, ledgers and schedules for training loops."""
