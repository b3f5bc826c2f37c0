#pragma once
#include <memory>
#include <vector>

#include "palpate/device/device.h"
#include "palpate/loop/haptic_record.h"

namespace palpate::loop {

/// Sets the record's hand on another clock: its times, and its twists by them.
void set_clock(HapticRecord& record, const device::RecordingClock& clock);
/// The hand of a record, moving as it did: at the times of its ticks to the last bit, between them on the
/// cubic through poses and twists, or on the nearest that stays between the two ticks; before the first and
/// after the last it rests.
/// @throws Error for a record without ticks
std::unique_ptr<device::Device> recorded_hand(HapticRecord record);
/// Of each hand.
std::vector<std::unique_ptr<device::Device>> recorded_hands(const std::vector<HapticRecord>& records);

/// The ticks of a hand's record again, each with the input and the contact record that it had: no body is
/// simulated, and of other hands those alone whose tools meet this one's.  Ticks of a run in real time come
/// out in virtual time as they were, bit for bit.
/// @param records  of all hands  @param hand  as scene::hands_of() counts
/// @throws Error for a tool without ticks of its own, for a record with ticks missing
std::vector<TickRecord> retrace(const scene::Description& description,
                                const std::vector<HapticRecord>& records, std::size_t hand = 0);

}  // namespace palpate::loop
