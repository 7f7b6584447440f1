#include "tools/argument_checks.h"

#include <cmath>
#include <sstream>

#include "app/exchange/text.h"

namespace sonoband::tools {

namespace {

bool same_file(const std::filesystem::path& a, const std::filesystem::path& b) {
  std::error_code error;
  if (std::filesystem::equivalent(a, b, error) && !error) return true;
  // One that is not there yet has no identity but its name.
  return std::filesystem::weakly_canonical(a, error) == std::filesystem::weakly_canonical(b, error);
}

std::string joined(const std::vector<std::pair<std::string, int>>& names, const std::string& between) {
  std::string text;
  for (const auto& [name, value] : names) text += (text.empty() ? "" : between) + name;
  return text;
}

}  // namespace

CLI::Validator number_between(double least, double most) {
  std::ostringstream words;
  words << least << " to " << most;
  const std::string range = words.str();
  return {[=](std::string& text) {
            const auto number = exchange::parse_number(text);
            const bool good = number && std::isfinite(*number) && *number >= least && *number <= most;
            return good ? std::string() : "'" + text + "' is not a number from " + range;
          },
          range};
}

void refuse_empty_values(CLI::App& verb) {
  const CLI::Validator something(
      [](std::string& text) {
        return text.empty() ? std::string("is empty; give a value, or leave it out") : std::string();
      },
      "");
  for (CLI::Option* option : verb.get_options())
    if (option->get_items_expected_max() > 0) option->check(something);
}

CLI::Validator one_of_values(const std::vector<std::pair<std::string, int>>& names) {
  return {[names](std::string& text) {
            for (const auto& [name, value] : names) {
              if (!exchange::same_name(text, name)) continue;
              text = std::to_string(value);
              return std::string();
            }
            return "'" + text + "' is none of " + joined(names, ", ");
          },
          joined(names, "|")};
}

void check_files_apart(const std::vector<NamedFile>& read, const std::vector<NamedFile>& written) {
  for (std::size_t i = 0; i < written.size(); ++i) {
    const auto& [option, path] = written[i];
    if (path.empty()) continue;
    for (const NamedFile& in : read)
      if (!in.path.empty() && same_file(path, in.path))
        throw CLI::ValidationError(option, path.string() + " is " + in.option +
                                               ", which is read and would be lost; name another file");
    for (std::size_t j = 0; j < i; ++j)
      if (!written[j].path.empty() && same_file(path, written[j].path))
        throw CLI::ValidationError(
            option, path.string() + " is also what " + written[j].option + " writes; name another file");
  }
}

}  // namespace sonoband::tools
