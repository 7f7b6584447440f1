// Checks of arguments beyond CLI11's own: its Range lets "nan" through, and of an enumeration its
// transformers print bytes instead of names.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace sonoband::tools {

// A finite number from `least` to `most`.
CLI::Validator number_between(double least, double most);

// Every option and positional of a verb wants something: a script's empty variable must not mean "all".
void refuse_empty_values(CLI::App& verb);

// Turns the name of a value into what CLI11 reads the value from; to be given to CLI::Option::transform.
CLI::Validator one_of_values(const std::vector<std::pair<std::string, int>>& names);

template <class Enumeration>
CLI::Validator one_of(const std::map<std::string, Enumeration>& names) {
  std::vector<std::pair<std::string, int>> values;
  for (const auto& [name, value] : names) values.emplace_back(name, static_cast<int>(value));
  return one_of_values(values);
}

// A file and what it was named by: an option or a positional. Empty paths do not count.
struct NamedFile {
  std::string option;
  std::filesystem::path path;
};

// Throws CLI::ValidationError where a file would be written over one that is read here, or over another that
// is written: one of them would be lost.
void check_files_apart(const std::vector<NamedFile>& read, const std::vector<NamedFile>& written);

}  // namespace sonoband::tools
