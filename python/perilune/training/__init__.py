"""What training loops need beside samples: batches, ledgers of streams, schedules."""
