#include "mesh/provenance.h"

#include "palpate/core/error.h"

namespace palpate::mesh {
namespace {

std::string place(const std::string& source, const std::vector<int>& lines, int i) {
  return lines.empty() ? source : fmt::format("{}:{}", source, lines[static_cast<std::size_t>(i)]);
}

std::string name(const std::string& noun, const std::vector<long>& numbers, int i) {
  return fmt::format("{} {}", noun, numbers.empty() ? i : numbers[static_cast<std::size_t>(i)]);
}

}  // namespace

std::string Provenance::node_name(int i) const { return name(node_noun, node_number, i); }

std::string Provenance::node(int i) const {
  return fmt::format("{}: {}", place(node_source.empty() ? source : node_source, node_line, i), node_name(i));
}

std::string Provenance::element(int e) const {
  return fmt::format("{}: {}", place(source, element_line, e), name(element_noun, element_number, e));
}

Provenance surface_provenance(std::string source) {
  Provenance out;
  out.source = std::move(source);
  out.node_noun = "vertex";
  out.element_noun = "face";
  return out;
}

}  // namespace palpate::mesh
