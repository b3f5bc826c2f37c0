#pragma once
#include <memory>
#include <vector>

#include "loop/haptic_record.h"
#include "palpate/device/device.h"

namespace palpate::loop {

/// Maps the times of a record to another clock, and scales its twists accordingly.
void set_clock(HapticRecord& record, const device::RecordingClock& clock);
/// Returns a device that repeats the motion of a record: bitwise at the times of its ticks, between them on
/// the cubic through poses and twists, or on the nearest cubic that stays between the two ticks; before the
/// first and after the last tick it is at rest.
std::unique_ptr<device::Device> recorded_hand(HapticRecord record);
/// Returns one such device per hand.
std::vector<std::unique_ptr<device::Device>> recorded_hands(const std::vector<HapticRecord>& records);

/// Returns whether the scene's devices all have a path that is known in advance (device::Device::path).
bool all_paths_known(const World& world);

/// Recomputes the ticks of a hand's record, each from its recorded input and contact record. No body is
/// simulated, and of the other hands only those whose tools meet this hand's tool; in the single-rate scheme,
/// tools and bodies are simulated again. Ticks of a run in real time are reproduced bitwise in virtual time.
/// @param records  records of all hands  @param hand  in the numbering of scene::hands_of()
/// @throws Error for a monolithic scene, and for a record with missing ticks
std::vector<TickRecord> retrace(const scene::Description& description,
                                const std::vector<HapticRecord>& records, std::size_t hand = 0);

}  // namespace palpate::loop
