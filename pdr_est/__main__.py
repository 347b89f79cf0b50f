"""Run the command line with `python -m pdr_est`, which works like `pdr-est`."""

from pdr_est.cli import main

if __name__ == "__main__":
    main(prog_name="pdr-est")
