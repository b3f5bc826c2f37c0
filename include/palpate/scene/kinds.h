#pragma once
#include <functional>
#include <string>
#include <vector>

#include "palpate/core/keys.h"
#include "palpate/scene/description.h"

/// Names and keys that the parts provide.  The loader only has tables and keys; the integrators, obstacles,
/// methods and generators that a name selects come from the registries, by loop::kinds().
namespace palpate::scene {

/// Name that a key may select, with the keys that apply to it.
struct Kind {
  std::string name;                ///< Name in the scene.
  std::vector<PartKey> keys = {};  ///< Keys that it uses and some other kinds do not.
  Settings values = {};            ///< Numbers that it gives to other keys of the table, unless a scene does.
};

/// Name that is commonly tried but does not exist, and the replacement that the message suggests.
struct AbsentKind {
  std::string name, answer;  ///< Name as commonly written; text that suggests a replacement.
};

/// Names that one key of one table selects from.  A key that some kinds of the table use is rejected where
/// the chosen kind does not use it.
struct KindTable {
  std::string table;                    ///< Dotted: "body.mesh".
  std::string selector;                 ///< Key that selects the kind: "generator".
  std::string what = {};                ///< Term in messages: "linear solver"; empty: the selector.
  std::vector<Kind> kinds;              ///< Existing kinds.
  std::vector<AbsentKind> absent = {};  ///< Commonly tried names that do not exist.
  /// Returns the default kind where the selector is not given; empty function: none.
  std::function<std::string(const Description&)> default_kind = {};
  std::string alternative = {};  ///< Key whose presence selects a kind: "file".
  /// Other keys of the scene whose texts are names of these kinds: "compare.contact_methods".
  std::vector<std::string> lists = {};
  /// Whether the kinds define all keys of the table except name and selector, as for obstacles.
  bool open = false;
};
/// Tables of all keys that select a part.
using Kinds = std::vector<KindTable>;

/// Documentation of one key of a scene.
struct KeyRow {
  std::string table;     ///< Dotted: "body.mesh".
  std::string name;      ///< Name of the key in its table.
  std::string type;      ///< Type: "number", "text", "three numbers", ...
  std::string unit;      ///< Unit: "Pa s/m"; empty: none.
  std::string range;     ///< Range: "> 0", "[0, 1]", or the admissible texts.
  std::string fallback;  ///< Default: TOML where `is_value`, else a description; empty: none, or required.
  std::string meaning;   ///< Description of one line.
  std::vector<std::string> users;           ///< Kinds that use the key; empty: all.
  bool required = false, is_value = false;  ///< Whether the key must be given; whether `fallback` is a value.
  /// Reads a TOML value as this key does, and returns the value in the scene's description as TOML.
  std::function<std::string(const std::string& toml)> read_back = {};
};

/// Returns every key that a scene may contain, table by table.
std::vector<KeyRow> key_rows(const Kinds& kinds);

}  // namespace palpate::scene
