#pragma once
#include <functional>
#include <string>
#include <vector>

#include "palpate/core/keys.h"
#include "palpate/scene/description.h"

/// What the parts say of the names in a scene: the loader knows tables and keys, but not the integrators,
/// obstacles, methods and generators that a name chooses among.  loop::kinds() makes it of the registries.
namespace palpate::scene {

/// One name that a key may choose, and the keys that go with it.
struct Kind {
  std::string name;                ///< as the scene writes it
  std::vector<PartKey> keys = {};  ///< that it uses and others do not
};

/// A name that is no kind, though people try it, and what a message says of it: which one to take.
struct AbsentKind {
  std::string name, answer;  ///< as people write it; what to take in its place
};

/// The names that one key of one table chooses among.  A key that some kinds of the table use and the chosen
/// one does not is refused.
struct KindTable {
  std::string table;                    ///< dotted: "body.mesh"
  std::string selector;                 ///< its key that names the kind: "generator"
  std::string what = {};                ///< of messages: "linear solver"; empty: the selector
  std::vector<Kind> kinds;              ///< that there are
  std::vector<AbsentKind> absent = {};  ///< that there are not
  /// the kind where the selector is not given; empty: none
  std::function<std::string(const Description&)> unsaid = {};
  std::string alternative = {};  ///< a key that names the kind by being there: "file"
  /// other keys of the scene whose texts are such names: "compare.contact_methods"
  std::vector<std::string> lists = {};
  /// the kinds bring all keys of the table but its own few: an obstacle's
  bool open = false;
};
/// All keys that choose a part.
using Kinds = std::vector<KindTable>;

/// A key of a scene, for people: one row of documentation.
struct KeyRow {
  std::string table;               ///< dotted: "body.mesh"
  std::string name;                ///< of the key, in its table
  std::string type;                ///< "number", "text", "three numbers", ...
  std::string unit;                ///< "Pa s/m"; empty: none
  std::string range;               ///< "> 0", "[0, 1]", or the texts that it may hold
  std::string fallback;            ///< as TOML where `is_value`, else in words; empty: nothing, or required
  std::string meaning;             ///< one line
  std::vector<std::string> users;  ///< kinds that use it; empty: all
  bool required = false, is_value = false;  ///< must be given; `fallback` is a value
  /// reads a TOML value as this key does, and gives back as TOML what the scene's description then holds
  std::function<std::string(const std::string& toml)> read_back = {};
};

/// Every key that a scene may contain, table by table.
std::vector<KeyRow> key_rows(const Kinds& kinds);

}  // namespace palpate::scene
