#include "store/table_file.h"

#include <bit>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <optional>

#include "core/sandbox.h"
#include "palpate/core/error.h"
#include "store/atomic_file.h"
#include "store/content_hash.h"
#include "store/series.h"

namespace palpate::store {
namespace {

/// Number of rows that are written at a time.
constexpr std::size_t kBatch = 256;

std::string joined(const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& name : names) out += (out.empty() ? "" : ",") + name;
  return out;
}

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> out;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t to = std::min(text.find(',', from), text.size());
    out.push_back(text.substr(from, to - from));
    from = to + 1;
  }
  return out;
}

/// Returns the hash of a journal, which consists of 64-bit words.
ContentHash content_of_journal(const std::string& journal, std::int64_t bytes) {
  const std::string rows = read_file(journal);
  std::vector<double> words(static_cast<std::size_t>(bytes) / sizeof(double));
  std::memcpy(words.data(), rows.data(), std::min(rows.size(), words.size() * sizeof(double)));
  return ContentHash().add_numbers(words);
}

/// Checks the journal before anything is changed.
void check_journal(const std::string& journal, const TableFile::Journal& from) {
  if (from.bytes == 0) return;
  check_reaches(journal, from.bytes);
  check_content(journal, content_of_journal(journal, from.bytes), from.content);
}

/// Table with rows that wait for the next batch.
struct Growing {
  h5::Id set;
  std::string name;
  std::size_t width = 0;
  hsize_t written = 0;
  std::vector<double> waiting;
};

Growing make(hid_t file, const TableSpec& spec, const std::string& path) {
  Growing out;
  out.name = spec.name;
  out.width = spec.columns.size();
  const hsize_t none[2] = {0, out.width}, most[2] = {H5S_UNLIMITED, out.width},
                chunk[2] = {kBatch, out.width};
  const h5::Id space{H5Screate_simple(2, none, most), H5Sclose};
  const h5::Id creation{H5Pcreate(H5P_DATASET_CREATE), H5Pclose};
  H5Pset_chunk(creation, 2, chunk);
  H5Pset_obj_track_times(creation, false);
  out.set = h5::Id{h5::check(H5Dcreate2(file, spec.name.c_str(), H5T_NATIVE_DOUBLE, space, H5P_DEFAULT,
                                        creation, H5P_DEFAULT),
                             path, "cannot create " + spec.name),
                   H5Dclose};
  h5::write_attribute_text(out.set, "columns", joined(spec.columns), path);
  out.waiting.reserve(kBatch * out.width);
  return out;
}

void write_waiting(Growing& table, const std::string& path) {
  if (table.waiting.empty()) return;
  const hsize_t rows = table.waiting.size() / table.width;
  const hsize_t size[2] = {table.written + rows, table.width}, from[2] = {table.written, 0},
                count[2] = {rows, table.width};
  h5::check(H5Dset_extent(table.set, size), path, "cannot extend " + table.name);
  const h5::Id in_file{H5Dget_space(table.set), H5Sclose};
  const h5::Id in_memory{H5Screate_simple(2, count, nullptr), H5Sclose};
  h5::check(H5Sselect_hyperslab(in_file, H5S_SELECT_SET, from, nullptr, count, nullptr), path,
            "cannot select rows of " + table.name);
  h5::check(H5Dwrite(table.set, H5T_NATIVE_DOUBLE, in_memory, in_file, H5P_DEFAULT, table.waiting.data()),
            path, "cannot write " + table.name + "; is the disk full?");
  table.written += rows;
  table.waiting.clear();
}

}  // namespace

struct TableFile::Impl {
  std::string path;
  h5::Id file;
  std::vector<Growing> tables;
  std::optional<std::ofstream> journal;
  ContentHash journal_content;

  void append(std::size_t number, std::span<const double> row) {
    Growing& table = tables.at(number);
    PALPATE_CHECK(row.size() == table.width, "{} values for {} columns of {}", row.size(), table.width,
                  table.name);
    table.waiting.insert(table.waiting.end(), row.begin(), row.end());
    if (table.waiting.size() < kBatch * table.width) return;
    const h5::Quiet quiet;
    write_waiting(table, path);
  }
  void write_journal(std::size_t number, std::span<const double> row) {
    const auto which = static_cast<std::uint64_t>(number);
    const double as_number = std::bit_cast<double>(which);
    journal_content.add_numbers({&as_number, 1}).add_numbers(row);
    journal->write(reinterpret_cast<const char*>(&which), sizeof which);
    journal->write(reinterpret_cast<const char*>(row.data()),
                   static_cast<std::streamsize>(row.size() * sizeof(double)));
  }
  void take_journal(const std::string& from, std::int64_t bytes);
};

/// Reads the journal's first bytes: rows, each preceded by the index of its table.
void TableFile::Impl::take_journal(const std::string& from, std::int64_t bytes) {
  std::ifstream in(from, std::ios::binary);
  std::vector<double> row;
  while (in.tellg() < bytes) {
    std::uint64_t number = 0;
    if (!in.read(reinterpret_cast<char*>(&number), sizeof number))
      fail("{}: ends within a row; the file is damaged", from);
    if (number >= tables.size())
      fail("{}: a row of table {}, of {} tables; the file is damaged", from, number, tables.size());
    row.resize(tables[static_cast<std::size_t>(number)].width);
    if (!in.read(reinterpret_cast<char*>(row.data()),
                 static_cast<std::streamsize>(row.size() * sizeof(double))))
      fail("{}: ends within a row; the file is damaged", from);
    append(static_cast<std::size_t>(number), row);
  }
}

TableFile::TableFile(const std::string& path, const std::vector<TableSpec>& tables)
    : impl_(std::make_unique<Impl>()) {
  const h5::Quiet quiet;
  impl_->path = path;
  impl_->file = h5::create_file(path);
  for (const TableSpec& spec : tables) impl_->tables.push_back(make(impl_->file, spec, path));
  flush();
}

TableFile::TableFile(const std::string& path, const std::vector<TableSpec>& tables, const Journal& from)
    : TableFile((check_journal(journal_path(path), from), path), tables) {
  const std::string journal = journal_path(path);
  if (from.bytes > 0) {
    impl_->take_journal(journal, from.bytes);
    impl_->journal_content = content_of_journal(journal, from.bytes);
    truncate_file(journal, from.bytes);
  }
  impl_->journal.emplace(journal, std::ios::binary | (from.bytes > 0 ? std::ios::app : std::ios::trunc));
  if (!*impl_->journal)
    fail("{}: cannot be written; check that its folder exists, is writable and is not full", journal);
  flush();
}

TableFile::Journal TableFile::place() {
  PALPATE_CHECK(impl_->journal, "{}: has no journal", impl_->path);
  flush();
  return {static_cast<std::int64_t>(std::filesystem::file_size(journal_path(impl_->path))),
          impl_->journal_content.hex()};
}

TableFile::~TableFile() {
  try {
    flush();
  } catch (const Error&) {}  // Reported by an explicit flush, if at all.
}

void TableFile::append(std::size_t number, std::span<const double> row) {
  impl_->append(number, row);
  if (impl_->journal) impl_->write_journal(number, row);
}

void TableFile::flush() {
  const h5::Quiet quiet;
  for (Growing& table : impl_->tables) write_waiting(table, impl_->path);
  h5::check(H5Fflush(impl_->file, H5F_SCOPE_LOCAL), impl_->path, "cannot be flushed; is the disk full?");
  if (impl_->journal && !impl_->journal->flush())
    fail("{}: could not be written completely; is the disk full?", journal_path(impl_->path));
}

namespace {
Table read_here(const std::string& path, const std::string& name) {
  const h5::Quiet quiet;
  if (!std::filesystem::exists(path)) fail("{}: no such file", path);
  const h5::Id file = h5::open_file(path);
  const h5::Opened set = h5::open(file, name, H5T_FLOAT, 2, path);
  Table out;
  out.columns = split(h5::read_attribute_text(set.id, "columns", path));
  if (out.columns.size() != set.shape[1])
    fail("{}: {} has {} columns, but {} names", path, name, set.shape[1], out.columns.size());
  out.values.resize(static_cast<std::size_t>(set.shape[0] * set.shape[1]));
  if (!out.values.empty()) h5::read(set, name, H5T_NATIVE_DOUBLE, out.values.data(), path);
  return out;
}
}  // namespace

Table read_table(const std::string& path, const std::string& name) {
  return rehearsed(path, "HDF5", [&] { return read_here(path, name); });
}

}  // namespace palpate::store
