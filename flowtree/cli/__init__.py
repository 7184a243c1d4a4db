"""The command line, one file a command."""

import os

# Before the first import of numpy, which starts them: stages run side by side, and threads of their own in
# each matrix product wait for each other, a tenth of the time.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
