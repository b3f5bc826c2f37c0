"""Moves the hand by a Python function: it presses a soft ball until the force reaches a target.

The function is called once per tick of 1 ms with the force on the hand at the tick before. It lowers the
handle at a speed proportional to the missing force, so that the force tends to the target."""
import palpate  # before NumPy, so that OpenBLAS starts as in the program

TARGET, GAIN = 0.3, 0.1  # [N], [m/s per N]


class Presser:
    """Handle above the ball that seeks a force along z."""

    def __init__(self, height):
        self.time, self.z = 0.0, height

    def __call__(self, time, force, torque):
        speed = GAIN * (TARGET - force[2])
        self.z -= speed * (time - self.time)
        self.time = time
        return palpate.HandlePose(position=(0.0, 0.0, self.z), velocity=(0.0, 0.0, -speed))


simulation = palpate.Simulation(palpate.load("scenes/press-ball.toml"), duration_s=1.5, hands=Presser(0.082))
while simulation.step():
    if simulation.time % 0.3 < 0.005:
        print(f"{simulation.time:.1f} s: {simulation.force[2]:.2f} N")
hand = simulation.hand()
print(f"{len(hand)} ticks; force {simulation.force[2]:.4f} N, target {TARGET} N; "
      f"handle {1e3 * (0.082 - hand.handle_positions[-1, 2]):.1f} mm lower")
