#pragma once
#include <vector>

#include "palpate/core/types.h"

namespace palpate::shapes {

/// Mutable closed triangle surface: half-edge h runs from vertex origin[h] to origin[next(h)] in face h/3,
/// and twin[h] runs back.  A surface with rims is closed by one ghost vertex per rim, joined to all of its
/// vertices, so that operations need no special case for rims.  Removed edges and vertices keep their number
/// and are skipped (origin -1, out -1).
class CornerTable {
 public:
  CornerTable() = default;
  /// @pre each edge in one face or two, oriented consistently
  explicit CornerTable(const Faces& faces, int vertices);

  static int next(int h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static int previous(int h) { return h % 3 == 0 ? h + 2 : h - 1; }
  int from(int h) const { return origin[h]; }
  int to(int h) const { return origin[next(h)]; }
  int opposite(int h) const { return origin[previous(h)]; }
  bool is_ghost(int v) const { return v >= first_ghost && v < last_ghost; }
  bool gone(int h) const { return origin[h] < 0; }
  bool touches_ghost(int h) const { return is_ghost(from(h)) || is_ghost(to(h)); }
  /// Whether the edge has a ghost on one side: it lies on a rim.
  bool on_rim(int h) const { return is_ghost(opposite(h)) || is_ghost(opposite(twin[h])); }

  /// Calls visit(h) for every half-edge out of v, in turn.
  template <class Visit>
  void around(int v, Visit&& visit) const {
    const int start = out[v];
    int h = start;
    do {
      visit(h);
      h = twin[previous(h)];
    } while (h != start);
  }
  /// Returns the number of edges at v, ghosts included.
  int valence(int v) const;

  int add_vertex();          ///< returns its number; it belongs to no face yet
  void flip(int h);          ///< rotates the edge within its two faces
  void split(int h, int m);  ///< inserts vertex m on the edge
  /// Merges from(h) into to(h).
  void collapse(int h);
  bool can_flip(int h) const;  ///< whether the new edge does not exist yet
  /// Whether the ends share the two opposite vertices and no other (link condition), and these keep at least
  /// three neighbours.
  bool can_collapse(int h) const;

  std::vector<int> origin, twin;  ///< three per face
  std::vector<int> out;           ///< an outgoing half-edge per vertex
  int first_ghost = 0, last_ghost = 0;

 private:
  void face(int f, int a, int b, int c);
  void join(int h, int t);
};

}  // namespace palpate::shapes
