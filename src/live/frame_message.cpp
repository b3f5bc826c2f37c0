#include "live/frame_message.h"

#include <algorithm>

#include "live/byte_writer.h"

namespace palpate::live {

void StripHistory::read(ForceStrip& strip) {
  for (StripRow row; strip.pop(row);) rows_.push_back(row);
  while (rows_.size() > ForceStrip::kCapacity) {
    rows_.pop_front();
    ++first_;
  }
}

void write_frame(const Frame& frame, const StripHistory& strip, std::size_t hands, std::uint64_t& next,
                 Bytes& bytes) {
  next = std::max(next, strip.first());
  const std::uint64_t end = strip.end();
  ByteWriter out(bytes, 2);
  out.add(frame.time_s);
  out.add(static_cast<std::uint32_t>(end - next));
  out.add(std::span<const float>(frame.values));
  for (; next < end; ++next)
    for (std::size_t i = 0; i < hands; ++i) {
      const StripSample& sample = strip.row(next)[i];
      out.add(static_cast<float>(std::min(0.0, sample.time_s - frame.time_s)));
      out.add(std::span<const float>(sample.force));
      out.add(std::span<const float>(sample.torque));
    }
  out.close();
}

}  // namespace palpate::live
