#pragma once
#include <array>

#include "palpate/device/device.h"
#include "rate_control.h"

/// Six-degree-of-freedom mouse by the daemon of the Spacenav project (Debian package spacenavd), over its
/// Unix socket, version 0 of its protocol, which its later versions answer, too. palpate speaks it itself: it
/// is one kind of packet, and needs no library.
///
/// A packet has eight i32 in the machine's byte order. The first is its kind:
///
///   0  motion   x, y, z, rx, ry, rz, period [ms]; x to the right, y up, z away from the user, left-handed
///   1  press    number of the button
///   2  release  number of the button
///
/// The daemon sends motion when it changes. Full deflection is about 350.
namespace palpate::device {

/// Deflection and buttons as the packets so far left them.
struct SpacemouseState {
  Deflection deflection;
  std::uint32_t switches = 0;
  long long motions = 0, buttons = 0, others = 0;  ///< Packets by kind.
};
/// One packet of the daemon.
using SpacemousePacket = std::array<std::int32_t, 8>;
/// Applies one packet. Packets of other kinds are counted.
void apply_packet(const SpacemousePacket& packet, SpacemouseState& state);

/// Returns the path of the daemon's socket: the scene's `input`, else $SPNAV_SOCKET, else /run/spnav.sock.
std::string spacemouse_socket(const DeviceSpec& spec);

}  // namespace palpate::device
