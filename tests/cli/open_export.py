"""Opens a file of `npdr export` by every library that is meant to open it. See open_export."""
import sys

import arviz
import getdist
import xarray

file = sys.argv[1]
for engine in ("h5netcdf", "netcdf4"):
    with xarray.open_dataset(file, group="posterior", engine=engine) as posterior:
        assert posterior["pole_length"].dims == ("chain", "draw"), posterior
        assert list(posterior["chain"].values) == [3, 5], posterior
        assert posterior["pole_length"].attrs["units"] == "m", posterior
    with xarray.open_dataset(file, group="posterior_predictive", engine=engine) as predicted:
        assert predicted["theta"].dims == ("chain", "draw", "rollout", "time"), predicted
        assert predicted["rollout"].values.tolist() == ["simulated 0", "simulated 1"], predicted["rollout"]
        assert abs(float(predicted["time"][0]) - 0.02) < 1e-12, predicted

data = arviz.from_netcdf(file)
groups = {"posterior", "posterior_predictive", "sample_stats", "prior", "observed_data", "constant_data"}
assert set(data.groups()) == groups, data.groups()
summary = arviz.summary(data)
assert set(summary.index) == {"pole_mass", "pole_length"}, summary
print(summary)

stan = arviz.summary(arviz.from_cmdstan(["chains_1.csv", "chains_2.csv"]))
assert stan.loc["pole_mass", "mean"] == summary.loc["pole_mass", "mean"], stan
chains = getdist.loadMCSamples("./chains", settings={"ignore_rows": 0})
assert chains.getParamNames().list() == ["pole_mass", "pole_length"], chains.getParamNames()
assert abs(chains.mean("pole_mass") - float(data.posterior["pole_mass"].mean())) < 1e-12
assert chains.ranges.getLower("pole_mass") == 0.3, chains.ranges
