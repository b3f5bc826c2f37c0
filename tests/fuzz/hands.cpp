// External inputs that move the handle: network packets and recordings.
#include <cmath>

#include "device/recorded_path.h"
#include "fuzz/input.h"
#include "fuzz/targets.h"
#include "palpate/device/udp.h"

namespace palpate::fuzz {

void udp_packet(std::string_view bytes) {
  const std::span packet(reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  if (device::PosePacket pose; device::decode(packet, pose) == device::PacketFault::kNone) {
    promise(std::isfinite(pose.time) && pose.pose.translation.allFinite() && pose.twist.linear.allFinite() &&
                pose.twist.angular.allFinite(),
            "an accepted pose is finite");
    promise(std::abs(pose.pose.rotation.norm() - 1.0) < 1e-12, "its quaternion has unit length");
    device::PosePacket again;
    promise(device::decode(device::encode(pose), again) == device::PacketFault::kNone &&
                again.sequence == pose.sequence && again.switches == pose.switches &&
                again.pose.translation == pose.pose.translation,
            "what is encoded is what was decoded");
  }
  if (device::WrenchPacket wrench; device::decode(packet, wrench) == device::PacketFault::kNone)
    promise(wrench.on_hand.force.allFinite() && wrench.on_hand.moment.allFinite(),
            "an accepted wrench is finite");
}

void recording(std::string_view bytes) {
  const InputFile file("fuzz.csv", bytes);
  is_read([&] {
    const std::vector<device::RecordedPose> poses = device::read_recording(file.path());
    const double first = poses.front().time, last = poses.back().time;
    constexpr int kSamples = 9;
    for (int i = 0; i < kSamples; ++i) {
      const device::HandleSample sample =
          device::sample_recording(poses, first + (last - first) * (i / (kSamples - 2.0)));
      promise(sample.pose.translation.allFinite() && sample.twist.linear.allFinite() &&
                  sample.twist.angular.allFinite() && sample.acceleration.linear.allFinite(),
              "the hand's motion is finite");
      promise(std::abs(sample.pose.rotation.norm() - 1.0) < 1e-9, "its rotation is one");
    }
  });
}

}  // namespace palpate::fuzz
