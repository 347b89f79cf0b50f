"""The fitted models lie in the repository's folder models/ and are installed within the package."""

from setuptools import find_packages, setup

setup(
    packages=[*find_packages(include=["pdr_est*"]), "pdr_est.models"],
    package_dir={"pdr_est.models": "models"},
)
