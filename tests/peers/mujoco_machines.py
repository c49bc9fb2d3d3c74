#!/usr/bin/env python3
"""Simulation of machines under a controller by MuJoCo (RK4, with contact), one thread.

Reads a request per line and answers each with a line, both JSON. A request is a machine and what it is to do:

    {"model": "mujoco_scara.xml", "axes": ["A1", ...], "position": [...], "tool": [x, y, z],
     "period": s, "set": [[q..., v..., effort...], ...], "kp": [...], "kd": [...]}

The machine begins at rest with its axes at position and its tool at tool. Every period the motors get, and hold,

    effort + kp (q_set - q) + kd (v_set - v)

and the answer is where the site "tip" is after each period, {"tips": [[x, y, z], ...]}. A number runs the machine
before once more, with the efforts it had, in one go of MuJoCo's own loop (mujoco.rollout); the answer is the time that
a period has taken, {"period": s}.

Models are beside this file. Joints of loops are found from where carriages and tool are: a rod reaches from the origin
of its body to its site "lower<n>", which is where the site "end<n>" is on the platform.
"""

import json
import pathlib
import sys
import time

import mujoco
import numpy as np
from mujoco import rollout

STATE = mujoco.mjtState.mjSTATE_FULLPHYSICS


class Machine:
    """A model with a controller."""

    def __init__(self, request):
        path = pathlib.Path(__file__).parent / request["model"]
        self.model = mujoco.MjModel.from_xml_path(str(path))
        self.data = mujoco.MjData(self.model)
        joints = [self.model.joint(name) for name in request["axes"]]
        self.at = np.array([joint.qposadr[0] for joint in joints])
        self.rate = np.array([joint.dofadr[0] for joint in joints])
        self.data.qpos[self.at] = request["position"]
        if self.model.neq:
            self.hang(np.array(request["tool"]))
        mujoco.mj_forward(self.model, self.data)
        self.start = np.zeros(mujoco.mj_stateSize(self.model, STATE))
        mujoco.mj_getState(self.model, self.data, self.start, STATE)
        self.steps = round(request["period"] / self.model.opt.timestep)
        self.controls = None

    def hang(self, tool):
        """Closes the loops of a tripod whose platform is level."""
        model, data = self.model, self.data
        mujoco.mj_kinematics(model, data)
        for number in range(1, 7):
            upper = data.body(f"rod{number}").xpos
            along = tool + model.site(f"end{number}").pos - upper
            hung = model.site(f"lower{number}").pos
            along, hung = along / np.linalg.norm(along), hung / np.linalg.norm(hung)
            # Half the way from where it hangs in the zero pose.
            turn = np.concatenate([[1.0 + along @ hung], np.cross(hung, along)])
            turn /= np.linalg.norm(turn)
            data.joint(f"ball{number}").qpos = turn
            if number == 1:
                # The platform hangs on this rod and is level.
                data.joint("platform").qpos = turn * [1.0, -1.0, -1.0, -1.0]

    def run(self, rows, kp, kd):
        model, data = self.model, self.data
        mujoco.mj_setState(model, data, self.start, STATE)
        tip = data.site("tip")
        count = len(self.at)
        tips, controls = [], []
        for row in np.array(rows):
            position, velocity, effort = row[:count], row[count : 2 * count], row[2 * count :]
            data.ctrl[:] = (
                effort
                + kp * (position - data.qpos[self.at])
                + kd * (velocity - data.qvel[self.rate])
            )
            controls.extend([data.ctrl.copy()] * self.steps)
            mujoco.mj_step(model, data, self.steps)
            mujoco.mj_kinematics(model, data)
            tips.append(tip.xpos.tolist())
        self.controls = np.array(controls)[None]
        return {"tips": tips}

    def again(self):
        start = time.perf_counter()
        rollout.rollout(self.model, [self.data], self.start[None], self.controls)
        return {"period": (time.perf_counter() - start) / (self.controls.shape[1] / self.steps)}


def main():
    machine = None
    for line in sys.stdin:
        request = json.loads(line)
        if isinstance(request, dict):
            machine = Machine(request)
            answer = machine.run(request["set"], np.array(request["kp"]), np.array(request["kd"]))
        else:
            answer = machine.again()
        print(json.dumps(answer), flush=True)


if __name__ == "__main__":
    main()
