#pragma once
#include <memory>
#include <vector>

#include "palpate/device/device.h"
#include "palpate/loop/haptic_record.h"

namespace palpate::loop {

/// The hand of a record, moving as it did: at the times of its ticks to the last bit, between them on the
/// cubic through poses and twists; before the first and after the last it rests.
/// @throws Error for a record without ticks
std::unique_ptr<device::Device> recorded_hand(HapticRecord record);

/// The ticks of a record again, each with the input and the linearised contact that it had: no body is
/// simulated.  Ticks of a run in real time come out in virtual time as they were, bit for bit.
/// @throws Error for a scene whose tool meets obstacles (linearised anew at each tick), for a tool without
///   ticks of its own, for a record with ticks missing
std::vector<TickRecord> retrace(const scene::Description& description, const HapticRecord& record);

}  // namespace palpate::loop
