#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>

#include "pliant/analysis/export.h"
#include "pliant/analysis/write_file.h"
#include "pliant/systems/error.h"

namespace pliant {

using namespace internal;

namespace {

constexpr std::size_t kBlock = 1 << 20;

/// As RFC 4180 says.
std::string Quoted(const std::string& name) {
  if (name.find_first_of(",\"\r\n") == std::string::npos) return name;
  std::string quoted;
  for (const char c : name) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return '"' + quoted + '"';
}

std::string Times(const RecordedSignal& signal) {
  const Eigen::VectorXd& t = signal.times;
  std::string text = signal.path + " : " + Text(t.size()) + " times";
  if (t.size() > 0) text += ", " + Text(t(0)) + " s to " + Text(t(t.size() - 1)) + " s";
  return text;
}

void Append(std::string& out, double number) {
  std::array<char, 32> text;
  out.append(text.data(), std::to_chars(text.data(), text.data() + text.size(), number).ptr);
}

}  // namespace

void ExportCsv(const Recording& recording, const std::filesystem::path& file,
               const std::vector<std::string>& paths, bool force) {
  std::vector<const RecordedSignal*> signals;
  for (const std::string& path : paths) signals.push_back(&recording[path]);
  if (paths.empty())
    for (const RecordedSignal& signal : recording.signals()) signals.push_back(&signal);
  if (signals.empty()) throw Error("cannot export " + file.string() + ": there are no signals");

  const Eigen::VectorXd& times = signals.front()->times;
  for (const RecordedSignal* signal : signals)
    if (signal->times.size() != times.size() || signal->times != times)
      throw Error("cannot export " + file.string() + ": the signals have different times\n  " +
                  Times(*signals.front()) + "\n  " + Times(*signal) +
                  "\nexport them to HDF5, or each to a file of its own");

  RequireNewFile(file, force);
  PartFile part(file);
  std::string out = "time (s)";
  for (const RecordedSignal* signal : signals)
    for (std::size_t i = 0; i < signal->elements.size(); ++i) {
      const std::string& unit = signal->units[i];
      out += ',' +
             Quoted(signal->path + signal->elements[i] + (unit.empty() ? "" : " (" + unit + ')'));
    }
  out += '\n';
  for (Eigen::Index k = 0; k < times.size(); ++k) {
    Append(out, times(k));
    for (const RecordedSignal* signal : signals)
      for (Eigen::Index i = 0; i < signal->numbers.rows(); ++i) {
        out += ',';
        Append(out, signal->numbers(i, k));
      }
    out += '\n';
    if (out.size() < kBlock) continue;
    part.Write(out);
    out.clear();
  }
  part.Write(out);
  part.MoveIntoPlace();
}

}  // namespace pliant
