#pragma once
#include <string>
#include <vector>

#include "report/table.h"

/// study.csv, taken apart: task, settings, status, reason, figures.
namespace palpate::report {

struct StudyColumns {
  std::vector<std::string> settings;  ///< all of them
  std::vector<std::string> swept;     ///< of these, the parameters of [[sweep]]
  std::vector<std::string> drawn;     ///< and those of [[random]], which follow from the seed
  bool seeds = false;
};
/// @throws Error where the table is no study's
StudyColumns columns_of_study(const Table& study);

/// A figure that a study's page shows first.
struct StudyFigure {
  std::string column, label;
};
/// Those that the table holds, with more than one value.
std::vector<StudyFigure> shown_figures(const Table& study);

/// Rows that share every setting but those in `without`, in the order of the table.
struct StudyGroup {
  std::string name;  ///< what tells it from the other groups; empty: there is only one
  std::vector<std::size_t> rows;
};
std::vector<StudyGroup> groups_of(const Table& study, const StudyColumns& columns,
                                  const std::vector<std::string>& without);

}  // namespace palpate::report
