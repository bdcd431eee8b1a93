"""Workers for a campaign's jobs: processes on this machine, or the workers of a Dask scheduler."""
