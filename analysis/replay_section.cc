#include "pliant/analysis/replay_section.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "pliant/analysis/page_data.h"
#include "pliant/analysis/write_file.h"
#include "pliant/plants/shared_file.h"

namespace pliant::internal {

namespace {

using Json = nlohmann::ordered_json;

Json Numbers(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

void AddPlace(Json& json, const Pose& pose) {
  const Eigen::Quaterniond q(pose.rotation);
  json["position"] = Numbers(pose.position);
  json["rotation"] = {q.w(), q.x(), q.y(), q.z()};
}

Json JsonOf(const Shape& shape, const Pose& X_BL) {
  Json json;
  const auto round = [&](const char* name) {
    json = {{"shape", name}, {"radius", shape.size.x()}, {"length", shape.size.y()}};
  };
  switch (shape.kind) {
    case Shape::Kind::Box:
      json = {{"shape", "box"}, {"size", Numbers(shape.size)}};
      break;
    case Shape::Kind::Sphere:
      json = {{"shape", "sphere"}, {"radius", shape.size.x()}};
      break;
    case Shape::Kind::Cylinder:
      round("cylinder");
      break;
    case Shape::Kind::Capsule:
      round("capsule");
  }
  AddPlace(json, X_BL * shape.pose);
  json["color"] = Numbers(shape.color.head<3>());
  return json;
}

/// Bodies are what moves; the links are frames on them.
std::string BodyName(int body) { return body < 0 ? "world" : "body " + std::to_string(body); }

Json JsonOf(const RobotModel& model, const std::string& tool) {
  Json links = Json::array({{{"name", "world"}, {"visuals", Json::array()}}});
  Json joints = Json::array();
  const auto bodies = model.bodies();
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Body& body = bodies[b];
    const Joint& joint = model.joint(body.joint);
    links.push_back({{"name", BodyName(static_cast<int>(b))}, {"visuals", Json::array()}});
    Json json{{"name", joint.name},
              {"parent", BodyName(body.parent)},
              {"child", BodyName(static_cast<int>(b))},
              {"type", body.revolute ? "revolute" : "prismatic"},
              {"axis", {0, 0, 1}}};
    AddPlace(json, body.pose);
    joints.push_back(std::move(json));
  }
  const auto add_frame = [&](const Link& link) {
    Json visuals = Json::array();
    for (const Shape& shape : link.visuals) visuals.push_back(JsonOf(shape, Pose{}));
    links.push_back({{"name", link.name}, {"visuals", std::move(visuals)}});
    Json json{{"name", "to " + link.name},
              {"parent", BodyName(link.body)},
              {"child", link.name},
              {"type", "fixed"},
              {"axis", {0, 0, 1}}};
    AddPlace(json, link.pose);
    joints.push_back(std::move(json));
  };
  // The path that is shown is that of the last.
  for (const Link& link : model.links())
    if (link.name != tool) add_frame(link);
  add_frame(model.link(model.link_index(tool)));
  return {{"links", links}, {"joints", joints}};
}

/// The arrow of a contact whose link is one of the robot's at some time.
std::optional<Json> ArrowOf(const RecordedSignal& contact, const RobotModel& model) {
  const Eigen::VectorXd link = contact["link"];
  const auto acts = std::ranges::find_if(link, [](double index) { return index >= 0; });
  if (acts == link.end() || *acts >= static_cast<double>(model.links().size())) return {};
  const Eigen::Index at = acts - link.begin();
  return Json{
      {"link", model.link(static_cast<int>(*acts)).name},
      {"point", {contact["point[x]"](at), contact["point[y]"](at), contact["point[z]"](at)}},
      {"columns",
       {contact.path + ".force[x]", contact.path + ".force[y]", contact.path + ".force[z]"}}};
}

/// The columns of all signals that have the times of the joints, the time first.
Json ColumnsOf(const RunData& run, PageColumns& columns) {
  Json names = Json::array({{{"name", "time"}, {"unit", "s"}}});
  columns.push_back({run.times().begin(), run.times().end()});
  for (const RecordedSignal& signal : run.log.signals()) {
    if (signal.times != run.times()) continue;
    for (std::size_t i = 0; i < signal.elements.size(); ++i) {
      std::string element = signal.elements[i];
      if (element.starts_with('[') && element.ends_with(']'))
        element = element.substr(1, element.size() - 2);
      names.push_back({{"name", signal.path + signal.elements[i]},
                       {"path", signal.path},
                       {"element", element},
                       {"unit", signal.units[i]}});
      const Eigen::RowVectorXd row = signal.numbers.row(static_cast<Eigen::Index>(i));
      columns.emplace_back(row.begin(), row.end());
    }
  }
  return names;
}

Json JsonOf(const RunData& run, std::size_t index, std::size_t characters, std::string& data) {
  PageColumns columns;
  const Json names = ColumnsOf(run, columns);
  FittedData fitted = FitPageData(columns, characters);
  Json joints = Json::array(), forces = Json::array(), bands = Json::array();
  for (const Body& body : run.arm.model.bodies())
    joints.push_back("arm.measured_position[" + run.arm.model.joint(body.joint).name + "]");
  for (const RecordedSignal& signal : run.log.signals())
    if (signal.type == ContactForce::quantity.name)
      if (auto arrow = ArrowOf(signal, run.arm.model)) forces.push_back(std::move(*arrow));
  const std::vector<Push::Options> pushes = PushesOf(run.scenario);
  for (std::size_t i = 0; i < pushes.size(); ++i)
    bands.push_back({{"from", pushes[i].start_s},
                     {"to", pushes[i].start_s + pushes[i].duration_s},
                     {"label", "push " + std::to_string(i + 1)}});
  data = std::move(fitted.text);
  return {{"title", run.title},  {"data", "data-" + std::to_string(index)},
          {"rows", fitted.rows}, {"decimation", fitted.decimation},
          {"columns", names},    {"joints", joints},
          {"forces", forces},    {"bands", bands}};
}

}  // namespace

ReplaySection ReplaySectionOf(const std::vector<const RunData*>& runs, std::size_t characters) {
  if (runs.empty()) return {};
  ReplaySection section;
  Json list = Json::array();
  for (std::size_t i = 0; i < runs.size(); ++i) {
    std::string data;
    list.push_back(JsonOf(*runs[i], i, characters / runs.size(), data));
    section.end +=
        "<script type=\"text/plain\" id=\"data-" + std::to_string(i) + "\">" + data + "</script>\n";
  }
  const RunData& first = *runs.front();
  const Json all{{"plots", {{"arm.measured_position"}, {"control.torque"}, {"control.pose_error"}}},
                 {"runs", list},
                 {"robot", JsonOf(first.arm.model, ToolOf(first.control))}};
  std::string json = all.dump(-1, ' ', false, Json::error_handler_t::replace);
  for (std::size_t at = 0; (at = json.find('<', at)) != std::string::npos;)
    json.replace(at, 1, "\\u003c");
  section.middle = "<section id=\"replay\"></section>\n";
  section.end += "<script type=\"application/json\" id=\"runs\">" + json + "</script>\n<style>" +
                 ReadFile(SharedFile("web/dist/replay.css")) + "</style>\n<script>" +
                 ReadFile(SharedFile("web/dist/replay.js")) + "</script>\n";
  return section;
}

}  // namespace pliant::internal
