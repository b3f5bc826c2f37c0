// Play, pause and the slider of the view.

/// A run is played in its own time, but never within less than this [s].
const LEAST_PLAY_S = 3;

export function makePlayer(holder, canvas, motion, draw) {
  const button = holder.querySelector("button"), slider = holder.querySelector("input");
  const clock = holder.querySelector("output"), times = motion.times_s, last = times.length - 1;
  const spanned = times[last] - times[0], pace = spanned > 0 ? Math.min(1, spanned / LEAST_PLAY_S) : 1;
  const digits = Math.max(0, Math.min(6, Math.ceil(-Math.log10(spanned / 200 || 1))));
  let playing = false, started = 0, from_s = 0;

  const show = (step) => {
    slider.value = step;
    const text = `${times[step].toFixed(digits)} s`;
    clock.textContent = text;
    slider.setAttribute("aria-valuetext", text);
    motion.show(step);
    draw();
  };
  const stepAt = (time_s) => {
    let step = 0;
    while (step < last && times[step + 1] <= time_s) ++step;
    return step;
  };
  const advance = (now) => {
    if (!playing) return;
    if (!started) started = now;
    const time_s = from_s + (pace * (now - started)) / 1000;
    const step = stepAt(time_s);
    if (step !== Number(slider.value)) show(step);
    if (time_s > times[last]) from_s = times[0], started = now;
    requestAnimationFrame(advance);
  };
  const play = (on) => {
    playing = on && last > 0;
    button.textContent = playing ? "Pause" : "Play";
    started = 0;
    from_s = Number(slider.value) === last ? times[0] : times[Number(slider.value)];
    if (playing) requestAnimationFrame(advance);
  };
  slider.max = last;
  slider.addEventListener("input", () => {
    play(false);
    show(Number(slider.value));
  });
  button.addEventListener("click", () => play(!playing));
  canvas.addEventListener("keydown", (event) => {
    if (event.key !== " ") return;
    play(!playing);
    event.preventDefault();
  });
  if (last === 0) button.disabled = slider.disabled = true;
  show(motion.first_shown);
}
