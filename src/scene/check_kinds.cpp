#include "scene/check_kinds.h"

#include <fmt/ranges.h>

#include <algorithm>

#include "palpate/core/registry.h"
#include "scene/keys.h"
#include "scene/reader.h"

namespace palpate::scene {
namespace {

/// Table of a scene that a KindTable describes: [integrator], or one of several [[contact]].
struct Instance {
  const toml::table* table;
  std::string path;   ///< Path: "contact[1]".
  std::string where;  ///< Label in messages: `contact between "ball" and "floor"`.
};

void find_instances(const toml::table& from, const std::string& dotted, const std::string& path,
                    const std::string& where, std::vector<Instance>& out) {
  const std::size_t dot = dotted.find('.');
  const std::string first = dotted.substr(0, dot);
  const auto go_on = [&](const toml::table& table, std::optional<std::size_t> index) {
    const std::string own = (path.empty() ? "" : path + ".") + first +
                            (index ? fmt::format("[{}]", *index) : ""),
                      label_here = label(where, first, table, index);
    if (dot == std::string::npos)
      out.push_back({&table, own, label_here});
    else
      find_instances(table, dotted.substr(dot + 1), own, label_here, out);
  };
  const toml::node* node = from.get(first);
  if (!node) return;
  if (const toml::table* table = node->as_table()) go_on(*table, {});
  if (!node->is_array_of_tables()) return;
  for (std::size_t i = 0; i < node->as_array()->size(); ++i) go_on(*node->as_array()->get(i)->as_table(), i);
}

std::string chosen(const KindTable& kinds, const toml::table& table, const Description& description) {
  if (!kinds.alternative.empty() && table.contains(kinds.alternative)) return kinds.alternative;
  if (const auto name = table[kinds.selector].value<std::string>(); name && !name->empty()) return *name;
  return kinds.default_kind ? kinds.default_kind(description) : "";
}

/// Returns the kind that the file selects without overrides; empty where the file alone is no valid scene.
std::string chosen_before(const KindTable& kinds, const toml::table& table,
                          const std::optional<Description>& before) {
  try {
    return before ? chosen(kinds, table, *before) : "";
  } catch (const Error&) { return ""; }  // A name in no registry.
}

bool from_override(const toml::node& node) {
  const toml::source_region& region = node.source();
  return region.path && region.path->starts_with("--set ");
}

const PartKey* find_key(const Kind& kind, std::string_view name) {
  for (const PartKey& key : kind.keys)
    if (key.name == name) return &key;
  return nullptr;
}

Names users_of(const KindTable& kinds, std::string_view key) {
  Names users;
  for (const Kind& kind : kinds.kinds)
    if (find_key(kind, key)) users.push_back(kind.name);
  return users;
}

/// Whether every kind that uses the key requires it.
bool is_always_required(const KindTable& kinds, std::string_view key) {
  bool used = false;
  for (const Kind& kind : kinds.kinds)
    if (const PartKey* found = find_key(kind, key)) {
      if (!found->required) return false;
      used = true;
    }
  return used;
}

std::string subject(const KindTable& kinds, const std::string& name) {
  if (name.empty()) return "a method without a " + kinds.what;
  if (!kinds.alternative.empty() && name == kinds.alternative) return "a mesh from a " + name;
  return kinds.what.empty() ? fmt::format("{} = \"{}\"", kinds.selector, name)
                            : fmt::format("{} \"{}\"", kinds.what, name);
}

/// Returns the names that the selector accepts.
Names selectable(const KindTable& kinds) {
  Names out = names(kinds.kinds);
  std::erase(out, kinds.alternative);
  return out;
}

/// Rejects `key = "name"`, a name of no kind.
[[noreturn]] void refuse_name(const KindTable& kinds, const std::string& at, const std::string& where,
                              const std::string& key, const std::string& name) {
  const std::string given = fmt::format("{} = \"{}\"", key, name);
  for (const AbsentKind& one : kinds.absent)
    if (one.name == name)
      refuse(at, where,
             fmt::format("{} {} (known: {})", given, one.answer, fmt::join(selectable(kinds), ", ")));
  refuse(at, where, given + " is not known" + suggestion(name, selectable(kinds)));
}

/// Checks names of kinds in a list elsewhere in the scene.
void check_list(const Document& document, const KindTable& kinds, const std::string& dotted) {
  const auto found = toml::at_path(document.root, dotted);
  const toml::array* list = found ? found.node()->as_array() : nullptr;
  if (!list) return;
  const std::size_t dot = dotted.rfind('.');
  const Names known = names(kinds.kinds);
  for (const toml::node& node : *list)
    if (const std::string name = node.value_or(std::string());
        std::find(known.begin(), known.end(), name) == known.end())
      refuse_name(kinds, location(node.source()), dotted.substr(0, dot), dotted.substr(dot + 1), name);
}

/// Checks the keys of one table against its kind.
class KindCheck {
 public:
  KindCheck(const KindTable& kinds, const Instance& at, std::string name, bool replaced)
      : kinds_(kinds), at_(at), name_(std::move(name)), replaced_(replaced) {
    const auto found = std::find_if(kinds.kinds.begin(), kinds.kinds.end(),
                                    [&](const Kind& kind) { return kind.name == name_; });
    if (found != kinds.kinds.end()) kind_ = &*found;
    const bool by_alternative = name_ == kinds.alternative && at.table->contains(kinds.alternative);
    if (name_.empty() || (kind_ && (by_alternative || name_ != kinds.alternative))) return;
    const toml::node* node = at.table->get(kinds.selector);
    refuse_name(kinds, location(node ? node->source() : at.table->source()), at.where, kinds.selector, name_);
  }

  void check(std::vector<DroppedKey>& left) const {
    for (const auto& [key, node] : *at_.table)
      check_key(std::string(key.str()), location(key.source()), node, left);
    if (!kind_) return;
    for (const PartKey& key : kind_->keys)
      if (key.required && !at_.table->contains(key.name))
        refuse(location(at_.table->source()), at_.where,
               fmt::format("{} is missing: {} needs it", key.name, subject(kinds_, name_)));
  }

 private:
  void check_key(const std::string& key, const std::string& key_location, const toml::node& node,
                 std::vector<DroppedKey>& left) const {
    if (key == kinds_.selector || key == kinds_.alternative) return;
    if (const PartKey* known = kind_ ? find_key(*kind_, key) : nullptr) return check_value(*known, node);
    const Names users = users_of(kinds_, key);
    if (!users.empty()) {
      if (replaced_ && !from_override(node))
        left.push_back({at_.path, key});
      else if (kind_ || kinds_.default_kind)
        refuse(location(node.source()), at_.where,
               fmt::format("{} does not apply to {}{}; remove it (used by {})", key, subject(kinds_, name_),
                           keys_taken(), fmt::join(users, ", ")));
      return;
    }
    if (!kinds_.open || key == "name") return;
    Names known = {"name", kinds_.selector};
    for (const PartKey& one : kind_->keys) known.push_back(one.name);
    refuse(key_location, at_.where, fmt::format("unknown key \"{}\"{}", key, suggestion(key, known)));
  }

  /// Returns `, which takes "step_s", ...`: the keys specific to the kind; empty where there are none.
  std::string keys_taken() const {
    Names taken;
    for (const PartKey& key : kind_ ? kind_->keys : std::vector<PartKey>{}) taken.push_back(key.name);
    return taken.empty() ? "" : fmt::format(", which takes {}", fmt::join(taken, ", "));
  }

  void check_value(const PartKey& key, const toml::node& node) const {
    const std::optional<Setting> value = setting_of(node);
    const std::string bad = value          ? fault_of(key, *value)
                            : key.fallback ? type_demand(*key.fallback)
                                           : std::string();  // Wrong type: reported by the key's table.
    if (!bad.empty())
      refuse(location(node.source()), at_.where, fmt::format("{} = {} {}", key.name, shown(node), bad));
  }

  const KindTable& kinds_;
  const Instance& at_;
  std::string name_;
  bool replaced_;
  const Kind* kind_ = nullptr;
};

/// Returns the description of the file before overrides; empty where the file alone is not valid.
std::optional<Description> read_original(const Document& document) {
  try {
    Description description;
    read_table(document.original, "", description_keys(), description);
    return description;
  } catch (const Error&) { return {}; }
}

}  // namespace

// A name that is not known is rejected here: without its values, the message would be about a missing key.
void fill_in_values(Document& document, const Kinds& kinds) {
  for (const KindTable& table : kinds) {
    if (std::all_of(table.kinds.begin(), table.kinds.end(), [](const Kind& k) { return k.values.empty(); }))
      continue;
    std::vector<Instance> found;
    find_instances(document.root, table.table, "", "", found);
    for (const Instance& at : found) {
      const toml::node* node = at.table->get(table.selector);
      const auto name = node ? node->value<std::string>() : std::nullopt;
      if (!name || name->empty()) continue;
      const auto kind = std::find_if(table.kinds.begin(), table.kinds.end(),
                                     [&](const Kind& one) { return one.name == *name; });
      if (kind == table.kinds.end())
        refuse_name(table, location(node->source()), at.where, table.selector, *name);
      toml::table& own = *toml::at_path(document.root, at.path).as_table();
      for (const auto& [key, value] : kind->values)
        if (const double* number = std::get_if<double>(&value)) own.emplace(key, *number);
    }
  }
}

std::vector<DroppedKey> check_kinds(const Document& document, const Description& description,
                                    const Kinds& kinds) {
  std::vector<DroppedKey> left;
  const std::optional<Description> before = read_original(document);
  for (const KindTable& table : kinds) {
    for (const std::string& list : table.lists) check_list(document, table, list);
    std::vector<Instance> now, original;
    find_instances(document.root, table.table, "", "", now);
    find_instances(document.original, table.table, "", "", original);
    for (const Instance& at : now) {
      const std::string name = chosen(table, *at.table, description);
      const auto same = std::find_if(original.begin(), original.end(),
                                     [&](const Instance& one) { return one.path == at.path; });
      const bool replaced = same != original.end() && chosen_before(table, *same->table, before) != name;
      KindCheck(table, at, name, replaced).check(left);
    }
  }
  return left;
}

std::vector<KeyRow> key_rows(const Kinds& kinds) {
  std::vector<KeyRow> rows = rows_of("", description_keys());
  for (const KindTable& table : kinds) {
    const auto in_table = [&](const KeyRow& row) { return row.table == table.table; };
    for (KeyRow& row : rows) {
      if (!in_table(row)) continue;
      constexpr std::size_t kWidest = 60;  // Longer lists have a separate `palpate list`.
      if (row.name == table.selector && choices(selectable(table)).size() <= kWidest)
        row.range = choices(selectable(table));
      const Names users = users_of(table, row.name);
      if (users.size() < table.kinds.size()) row.users.insert(row.users.end(), users.begin(), users.end());
      if (is_always_required(table, row.name)) {
        row.required = true;
        row.is_value = false;
        row.fallback.clear();
      }
    }
    if (!table.open) continue;
    std::vector<KeyRow> more;
    for (const Kind& kind : table.kinds)
      for (const PartKey& key : kind.keys) {
        const auto again = std::find_if(more.begin(), more.end(), [&](const KeyRow& row) {
          return row.name == key.name && row.meaning == key.meaning;
        });
        if (again != more.end()) {
          again->users.push_back(kind.name);
          continue;
        }
        KeyRow row{.table = table.table,
                   .name = key.name,
                   .type = type_name(*key.fallback),
                   .unit = unit_of(key.name),
                   .range = key.range.text(),
                   .fallback = key.required ? "" : palpate::to_toml(*key.fallback),
                   .meaning = key.meaning,
                   .users = {kind.name},
                   .required = key.required,
                   .is_value = !key.required};
        row.read_back = [key](const std::string& toml) {
          std::string out;
          with_value(toml, key.name, [&](const Value& v) {
            const auto value = setting_of(v.node);
            if (!value || !fault_of(key, *value).empty()) fail("{} = {} is rejected", key.name, toml);
            out = palpate::to_toml(*value);
          });
          return out;
        };
        more.push_back(std::move(row));
      }
    auto end = rows.begin();
    for (auto it = rows.begin(); it != rows.end(); ++it)
      if (in_table(*it)) end = it + 1;
    rows.insert(end, more.begin(), more.end());
  }
  return rows;
}

}  // namespace palpate::scene
