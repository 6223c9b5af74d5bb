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
# # A first mission
#
# Six robots stand around a load and move it along three legs: some push, some give way in front of it, some keep it from
# slipping out sideways. Numbers are in SI units and radians.

# %%
import cohaul
import matplotlib.pyplot as plt
import numpy as np

SCENARIO = """
format: cohaul/1
name: first_mission
description: Six robots move a load of 2 kg over flat ground.
world: planar
terrain: {friction: {dynamic: 0.01, wheel: 0.9}}
loads: [{id: load, shape: {rectangle: {length: 1.35, width: 0.35}}, mass: 2.0}]
teams:
  - id: team
    load: load
    robots: {count: 6}
    formation: {slots: six}
    mission: {waypoints: [{x: 1.0, y: 0.4}, {x: 2.0, y: 0.0}], goal: {x: 3.0, y: 0.5}}
    controller: {r2p2: {rotation_gain: 0.25, translation_gain: 0.3, speed_min: 0.1}}
"""

# %% [markdown]
# An outcome shows itself as a page that plays the mission. `SCENARIO` could as well be the name of a file.

# %%
outcome = cohaul.run(SCENARIO, seed=1)
outcome

# %%
print(outcome)

# %% [markdown]
# Everything that happened is in `outcome.traces`, one NumPy array for each quantity. Here is the path of the load with its
# outline once in a while.

# %%
traces = outcome.traces
x, y, yaw = traces.load_pose[:, 0].T
corners = np.array([[-0.175, -0.675], [0.175, -0.675], [0.175, 0.675], [-0.175, 0.675], [-0.175, -0.675]])

fig, ax = plt.subplots(figsize=(8, 4))
for i in range(0, len(x), len(x) // 8):
    turn = np.array([[np.cos(yaw[i]), -np.sin(yaw[i])], [np.sin(yaw[i]), np.cos(yaw[i])]])
    ax.plot(*(turn @ corners.T + [[x[i]], [y[i]]]), color="0.8")
ax.plot(x, y)
ax.plot([1.0, 2.0, 3.0], [0.4, 0.0, 0.5], "o")
ax.set(aspect="equal", xlabel="x [m]", ylabel="y [m]", title="Path of the load")
plt.show()

# %% [markdown]
# How many robots push, give way and support as the load turns and translates?

# %%
fig, ax = plt.subplots(figsize=(8, 3))
roles = [cohaul.Role.PUSH, cohaul.Role.PREVENT, cohaul.Role.SUPPORT]
ax.stackplot(traces.time, [(traces.role == role).sum(axis=1) for role in roles], labels=[r.name.lower() for r in roles])
ax.set(xlabel="time [s]", ylabel="robots")
ax.legend(loc="lower right")
plt.show()

# %% [markdown]
# Keys of the scenario can be set to other values: two underscores stand for a dot. Does a slope slow the team down?

# %%
for slope_deg in (-5.0, 0.0, 5.0):
    tilted = cohaul.run(SCENARIO, seed=1, terrain__slope_deg=slope_deg)
    print(f"{slope_deg:+.0f}°: {tilted.outcome} after {tilted.time_s:.0f} s, {tilted.energy_j:.1f} J")

# %% [markdown]
# The friction of the ground resists sliding and turning together. Its limit surface tells the wrench for each twist.

# %%
surface = cohaul.LimitSurface.rectangle(along_x=0.35, along_y=1.35)
print(surface.wrench(twist=[0.1, 0.0, 0.2], limit=0.01 * 2.0 * 9.81))
