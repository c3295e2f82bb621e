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

draws = data.posterior.to_dataframe()
samples = getdist.MCSamples(samples=[chain.to_numpy() for _, chain in draws.groupby("chain")], names=list(draws))
assert samples.getParamNames().list() == ["pole_length", "pole_mass"], samples.getParamNames()
assert abs(samples.mean("pole_mass") - float(data.posterior["pole_mass"].mean())) < 1e-12
