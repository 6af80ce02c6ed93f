"""Compares the HDF5 file that export_test.cc writes with what it must hold, as h5py reads it.

    export_h5py.py FILE
"""

import sys

import h5py
import numpy as np

with h5py.File(sys.argv[1]) as run:
    velocity = run["arm/velocity"]
    expected = np.array([[1 / 3, 2], [-0.0, np.inf], [1e-310, 1e300]])
    assert velocity["data"][:].tobytes() == expected.tobytes(), velocity["data"][:]
    assert velocity["data"].dtype == "<f8"
    assert velocity["data"].compression == "gzip" and velocity["data"].shuffle
    assert velocity["time"][:].tolist() == [0, 0.1, 0.2], velocity["time"][:]
    assert velocity["time"].attrs["unit"] == "s"
    assert velocity.attrs["type"] == "joint velocity"
    assert velocity.attrs["elements"].tolist() == ["[shoulder]", "[elbow]"]
    assert velocity.attrs["units"].tolist() == ["rad/s", "rad/s"]
    assert run["arm/mode/data"][:].tolist() == [[1], [2], [3]]
    assert run["arm/mode"].attrs["elements"].tolist() == [""]
    assert run["energy/time"][:].tolist() == [0, 0.2]
    assert run["energy/torque"].attrs["units"].tolist() == ["N·m"]
    assert run["energy/torque/data"].shape == (0, 1)
    assert run["arm/nothing"].attrs["elements"].shape == (0,)
    assert run["arm/nothing"].attrs["units"].shape == (0,)
    assert sorted(run["arm/nothing"]) == ["time"]
    assert dict(run["metadata/pliant"].attrs) == {"seed": "7"}
    assert run.attrs["robot_description"] == "x" * 100000
    assert sorted(run) == ["arm", "energy", "metadata"]
