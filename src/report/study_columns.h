#pragma once
#include <string>
#include <vector>

#include "report/table.h"

/// Columns of study.csv: task, settings, status, reason, figures.
namespace palpate::report {

/// Setting columns of a study by their role.
struct StudyColumns {
  std::vector<std::string> settings;  ///< All setting columns
  std::vector<std::string> swept;     ///< Parameters of [[sweep]] among them
  std::vector<std::string> drawn;     ///< Parameters of [[random]] among them, which follow from the seed
  bool seeds = false;                 ///< Whether there is a seed column
};
/// Returns the setting columns of a study.
/// @throws Error if the table is not the table of a study
StudyColumns columns_of_study(const Table& study);

/// Returns a parameter as the label of an axis, with its unit: "body.0.youngs_modulus_pa" becomes "body 0:
/// youngs modulus [Pa]".
std::string parameter_text(const std::string& name);

/// Figure that the page of a study shows first.
struct StudyFigure {
  std::string column, label;
};
/// Returns the figures that the table contains with more than one value.
std::vector<StudyFigure> shown_figures(const Table& study);

/// Rows that share all settings except the excluded ones, in the order of the table.
struct StudyGroup {
  std::string name;  ///< Settings that distinguish the group from others; empty if there is only one group
  std::vector<std::size_t> rows;
};
/// Returns the groups of rows that share all settings except `without`.
std::vector<StudyGroup> groups_of(const Table& study, const StudyColumns& columns,
                                  const std::vector<std::string>& without);

}  // namespace palpate::report
