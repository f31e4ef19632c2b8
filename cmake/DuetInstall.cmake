# Filled in by the packaging slice.
