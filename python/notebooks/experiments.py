# ---
# jupyter:
#   jupytext:
#     text_representation:
#       extension: .py
#       format_name: percent
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---

# %% [markdown]
# # Figures of experiments
#
# `cohaul.plot` draws missions, trials and the controller; `pip install cohaul[plot]` brings what it needs. Every function
# returns a matplotlib figure, and `path=` saves it as PNG or SVG. Numbers are in SI units and radians.

# %%
import itertools

import cohaul
import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

SCENARIO = """
format: cohaul/1
name: three_legs
world: planar
terrain: {slope_deg: -5, friction: {dynamic: 0.01, wheel: 0.9}}
loads: [{id: load, shape: {rectangle: {length: 1.35, width: 0.35}}, mass: 2.0}]
teams:
  - id: team
    load: load
    robots: {count: 6}
    formation: {slots: six}
    mission: {waypoints: [{x: 1.0, y: 0.4}, {x: 2.0, y: 0.0}], goal: {x: 3.0, y: 0.5}, time_limit: 400}
    controller: {r2p2: {stance: square}}
start: {position_jitter: 0.002, yaw_jitter_deg: 0.5}
"""

# %% [markdown]
# ## A mission from above
#
# Six robots move a load downhill, standing square to its edges as in the paper. They are drawn at four instants, coloured
# by role.

# %%
outcome = cohaul.run(SCENARIO, seed=1)
cohaul.plot.trajectory(outcome)
plt.show()

# %% [markdown]
# The outcome itself plays the mission.

# %%
outcome

# %% [markdown]
# ## A rotation in time
#
# The load turns by 75° towards its goal. A robot that is square to the edge drifts along it while the load turns, and has
# to reposition itself; meanwhile the others hold.

# %%
bearing = np.radians(75)
goal = {"goal": {"x": np.cos(bearing), "y": np.sin(bearing)}}
turn = cohaul.run(SCENARIO, seed=1, terrain__slope_deg=0, set={"teams.0.mission": goal})
cohaul.plot.rotation_traces(turn)
plt.show()

# %% [markdown]
# With `stance: arc` robots stand along the arc that their place moves on, and the load turns in one go.

# %%
change = {"teams.0.mission": goal, "teams.0.controller.r2p2.stance": "arc"}
cohaul.plot.rotation_traces(cohaul.run(SCENARIO, seed=1, terrain__slope_deg=0, set=change))
plt.show()

# %% [markdown]
# ## Many trials
#
# A table with one row a trial: the levels of the factors, `outcome` and `time_s`, and `terrain` if there are several.
# Results of `cohaul reproduce` are read from their folder instead.

# %%
rows = []
for gain, speed_min, mass, seed in itertools.product((0.125, 0.25, 0.5), (0.1, 0.15, 0.2), (1.0, 10.0, 20.0), (1, 2)):
    keys = {"rotation_gain": gain, "speed_min": speed_min}
    changes = {"teams.0.mission": {**goal, "time_limit": 100}, "teams.0.controller.r2p2": keys, "loads.0.mass": mass}
    trial = cohaul.run(SCENARIO, seed=seed, set=changes, terrain__slope_deg=0, terrain__friction__dynamic=0.1)
    rows.append({**keys, "mass": mass, "terrain": "flat", "outcome": trial.outcome, "time_s": trial.time_s})
trials = pd.DataFrame(rows)
cohaul.plot.main_effects(trials, factors={"rotation_gain": "gain", "speed_min": "least speed", "mass": "mass"})
plt.show()

# %% [markdown]
# How often do they get there? The band is a 95 % confidence interval.

# %%
cohaul.plot.success_curves(trials, factor="mass")
plt.show()

# %% [markdown]
# ## What a robot does
#
# The flowchart is drawn from tables that the controllers are tested against.

# %%
cohaul.plot.flowchart()
plt.show()
