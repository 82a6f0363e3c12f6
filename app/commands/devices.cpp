#include <fmt/format.h>

#include "app/commands/command.h"
#include "haptic/devices/enumerate.h"

namespace fettle::app {

namespace {

using haptic::DeviceInfo;
using haptic::DeviceKind;
using haptic::DeviceProfile;

// Every entry has the same keys. Limits are null where the device has none of the kind.
Report entry(const std::string& id, const std::string& name, std::string_view kind, const std::string& state,
             const std::string& remedy, const DeviceProfile& profile) {
  const auto forceOnly = [&](double value) { return profile.gives_force ? Report(value) : Report(); };
  return {{"id", id},
          {"name", name},
          {"kind", std::string(kind)},
          {"state", state},
          {"remedy", remedy.empty() ? Report() : Report(remedy)},
          {"force", profile.gives_force},
          {"workspace_radius_mm", profile.space == haptic::DeviceSpace::kDesk
                                      ? Report(profile.workspace_radius_mm)
                                      : Report()},  // moves in the field itself
          {"max_force_n", forceOnly(profile.max_force_n)},
          {"max_stiffness_n_per_mm", forceOnly(profile.max_stiffness_n_per_mm)},
          {"max_damping_n_s_per_mm", forceOnly(profile.max_damping_n_s_per_mm)},
          {"resolution_mm", profile.resolution_mm > 0.0 ? Report(profile.resolution_mm) : Report()},
          {"rate_hz", profile.rate_hz},
          {"tested_on_hardware", false}};
}

Report pluggedIn(const DeviceInfo& d) {
  const haptic::DeviceProblem problem =
      d.open_error != 0 ? haptic::deviceProblem(d.open_error) : haptic::DeviceProblem{d.answer, d.advice};
  const bool usable = d.kind != DeviceKind::kOther;
  Report row = entry(d.path, d.name, haptic::deviceKindName(d.kind),
                     !usable                ? "no driver"
                     : problem.what.empty() ? "ready"
                                            : problem.what,
                     usable ? problem.remedy : "", d.profile);
  if (!usable)
    for (const char* key : {"workspace_radius_mm", "max_force_n", "max_stiffness_n_per_mm",
                            "max_damping_n_s_per_mm", "resolution_mm", "rate_hz"})
      row[key] = nullptr;  // not known
  row["serial"] = d.serial;
  row["usb_id"] = d.vendor == 0 ? Report() : Report(fmt::format("{:04x}:{:04x}", d.vendor, d.product));
  row["form"] = d.form.empty() ? Report() : Report(std::string(d.form));
  row["limits_of"] = usable && d.gives_force ? Report(d.profile.name) : Report();
  return row;
}

Report builtIn(const std::string& id, const std::string& name, const std::string& state,
               const std::string& remedy, const DeviceProfile& profile) {
  Report row = entry(id, name, "built in", state, remedy, profile);
  row["serial"] = "";
  row["usb_id"] = row["form"] = row["limits_of"] = nullptr;
  return row;
}

Report makerOf(const haptic::MakerInfo& m) {
  return {{"id", std::string(m.word)},
          {"name", std::string(m.title)},
          {"state", m.problem.empty() ? m.devices.empty() ? "no device" : "ready" : m.problem},
          {"remedy", m.remedy.empty() ? Report() : Report(m.remedy)},
          {"source", m.source.empty() ? Report() : Report(m.source)}};
}

engine::Result<Report> devices() {
  Report rows = Report::array();
  for (const DeviceInfo& d : haptic::listDevices()) rows.push_back(pluggedIn(d));
  Report makers = Report::array();
  for (const haptic::MakerInfo& m : haptic::listMakers()) {
    for (const DeviceInfo& d : m.devices) rows.push_back(pluggedIn(d));
    makers.push_back(makerOf(m));
  }
  // A connected device needs no path: the first one found is used.
  for (const haptic::KnownDriver& driver : haptic::knownDrivers()) {
    if (driver.kind != DeviceKind::kOther) continue;
    DeviceProfile profile;  // without strokes a replay has no position
    profile.space = haptic::DeviceSpace::kField;
    if (const auto device = driver.open("", 1000.0)) profile = (*device)->profile();
    rows.push_back(builtIn(
        fmt::format("{}{}{}", driver.word, driver.argument.empty() ? "" : ":", driver.argument),
        std::string(driver.title), driver.needs_window ? "needs a window" : "ready",
        driver.needs_window ? "the cursor points at the picture: see fettle view --help" : "", profile));
  }
  return Report{{"devices", rows}, {"makers", makers}};
}

std::string known(const Report& value, double factor, const char* unit) {
  return value.is_null() ? "-" : fmt::format("{:.3g} {}", value.get<double>() * factor, unit);
}

void printDevices(const Report& report) {
  bool any = false;
  for (const Report& d : report["devices"]) {
    any = any || d["kind"] != "built in";
    fmt::print("{}\n  {}, {}: {}\n", d["id"].get<std::string>(), d["name"].get<std::string>(),
               d["kind"].get<std::string>(), d["state"].get<std::string>());
    if (d["state"] == "no driver") continue;
    if (d["force"].get<bool>())
      fmt::print("  force up to {}, stiffness {}, damping {}; {} Hz\n", known(d["max_force_n"], 1.0, "N"),
                 known(d["max_stiffness_n_per_mm"], 1.0, "N/mm"),
                 known(d["max_damping_n_s_per_mm"], 1000.0, "N s/m"), d["rate_hz"].get<double>());
    else
      fmt::print("  no force; {} Hz\n", d["rate_hz"].get<double>());
    if (!d["workspace_radius_mm"].is_null())
      fmt::print("  workspace of {} radius, resolution {}\n", known(d["workspace_radius_mm"], 1.0, "mm"),
                 known(d["resolution_mm"], 1.0, "mm"));
    if (!d["remedy"].is_null()) fmt::print("  {}\n", d["remedy"].get<std::string>());
    if (d["kind"] != "built in") fmt::print("  not tested on hardware, only with a simulated device\n");
  }
  for (const Report& m : report["makers"]) {
    if (m["state"] == "ready") continue;
    fmt::print("{}\n  {}: {}\n", m["id"].get<std::string>(), m["name"].get<std::string>(),
               m["state"].get<std::string>());
    if (!m["source"].is_null() && m["remedy"].is_null()) fmt::print("  {}\n", m["source"].get<std::string>());
    if (!m["remedy"].is_null()) fmt::print("  {}\n", m["remedy"].get<std::string>());
  }
  if (!any) fmt::print("\nNo force device or 3D mouse is connected.\n");
}

}  // namespace

void addDevices(Command root, Chosen& chosen) {
  addCommand(
      root, chosen, "devices",
      "Connected devices and their properties; use an id with fettle record --device",
      [](engine::JobControl&) { return devices(); }, printDevices);
}

}  // namespace fettle::app
