#pragma once

namespace palpate::bench {

/// What one query looks at.
struct QueryCounts {
  double nodes = 0.0;    ///< of the bodies
  double faces = 0.0;    ///< of both skins that pruning hands on
  double pixels = 0.0;   ///< of all its images
  double samples = 0.0;  ///< that it makes
};

/// What a query must read from memory and write to it, each thing once [bytes]; against the bandwidth of
/// copying it says how far from the memory's speed a query is.  In double, with indices of 32 bits:
///   node    its position, read and kept: 2 x 24
///   face    three corners, 12; and half a vertex: four weights and a tetrahedron, 36, and its position,
///           written and read, 48: 12 + 42 = 54
///   pixel   depth and triangle of both sides, written and read: 2 x 2 x 8
///   sample  two sides of four nodes, weights and an offset, 72 each, normal, area and gap, 40, written; and
///           weights of both sides, area and gap, 80, written again for the sums over shared nodes: 264
double query_bytes(const QueryCounts& counts);

}  // namespace palpate::bench
