"""Run the command line with ``python -m radmpc``."""

from radmpc.cli import main

if __name__ == "__main__":
    main()
