#include <memory>
#include <nlohmann/json.hpp>

#include "app/exchange/removable.h"
#include "tools/verbs.h"

namespace sonoband::tools {

void add_places(CLI::App& tool) {
  auto json = std::make_shared<bool>(false);
  CLI::App* verb = tool.add_subcommand("places", "List the sticks and cards that are there to export to");
  verb->add_flag("--json", *json, "As {\"places\":[{\"label\", \"path\", \"removable\"}]}");
  verb->callback([json] {
    const std::vector<exchange::Place> places = exchange::removable_places();
    if (*json) {
      nlohmann::json list = nlohmann::json::array();
      for (const exchange::Place& p : places)
        list.push_back({{"label", p.label}, {"path", p.path}, {"removable", p.removable}});
      std::printf("%s\n", nlohmann::json({{"places", list}})
                              .dump(2, ' ', false, nlohmann::json::error_handler_t::replace)
                              .c_str());
      return;
    }
    for (const exchange::Place& p : places) std::printf("%s  %s\n", p.path.c_str(), p.label.c_str());
    if (places.empty()) std::printf("no stick or card is mounted\n");
  });
}

}  // namespace sonoband::tools
