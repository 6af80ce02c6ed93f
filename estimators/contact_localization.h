#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pliant/estimators/self_filter.h"
#include "pliant/estimators/touching_points.h"
#include "pliant/plants/contacts.h"
#include "pliant/systems/block.h"

namespace pliant {

/// What a localisation by sight goes by.
struct ContactSight {
  using Space = Nothing;
  static constexpr Quantity quantity{"sight of contacts", ""};

  double age = -1;                        ///< of the last picture looked at [s]; −1: none yet
  int points = 0;                         ///< near the arm and not its own, in that picture
  std::array<bool, kMaxContacts> seen{};  ///< there, or else kept by tracking, of each contact
  bool unseen = false;                    ///< the arm is touched, and no contact is known

  template <class Visitor>
  void Fields(Visitor&& f) {
    f("age", age, "s");
    f("points", points, "");
    f("seen", seen, "");
    f("unseen", unseen, "");
  }
};

/// Where an arm is touched, from pictures of a depth camera: the arm is taken out of the picture by
/// its own model (SelfFilter), what is left near its surface is where it is touched
/// (TouchingPoints), and contacts are followed from picture to picture.
///
/// While `touched`, which a residual says, a place that is seen joins the contact it is nearest to,
/// or begins one. A contact is a point p of a link, so it moves with the arm by itself; a place
/// within `separation` of it moves it by
///
///   p ← p + α (p_seen − p),   then to the nearest point of the surface,
///
/// and it stays on its link until another one is nearer to what is seen by more than 2 cm. A
/// contact that is not seen is kept where a body hides it, and where no other one is seen: the arm
/// is touched, and there is no better place. Else it ends after `patience` pictures. When the arm
/// is not touched any more all contacts end.
///
/// `isolated` is the last link whose joints feel the touch: a contact cannot be on one before it.
/// With several contacts that holds for one of them, so nothing new is taken from a picture where
/// neither a place seen nor a contact known is on that link or behind it. Where an arm is touched
/// and no hand was seen, as one behind the arm, there are no contacts and `unseen` is told.
///
/// Forces of the contacts are zero: they are for a force estimate to find.
///
/// Every period one picture is looked at, once, if it is not older than a period and as large as
/// `view` says; the outputs are held. Assumes: the joint angles are those of that instant, or as
/// old as a tick of the arm, 1 mm of a point at 0.2 m/s in 5 ms; the shapes of the model are the
/// arm's surface up to `margin`. What hovers within `reach` of the arm
/// while it is touched elsewhere is taken for a contact.
///
/// Source: Magrini, Flacco & De Luca, Estimation of contact forces using a virtual force sensor,
/// IROS 2014; Control of generalized contact motion and force, ICRA 2015, II.
class ContactLocalization final : public Block {
 public:
  struct Options {
    RobotModel model;
    Pinhole view = {};      ///< of the camera
    DepthNoise noise = {};  ///< of the camera
    std::vector<Obstacle> obstacles = {};
    Duration period = Hertz(30);
    double margin = 0.005;        ///< of the arm's surface [m]
    double reach = 0.06;          ///< how near is touching, half a hand's thickness and noise [m]
    double band = 0.01;           ///< of the nearest points that are averaged [m]
    int least_points = 15;        ///< of what touches
    int contacts = kMaxContacts;  ///< at most
    double separation = 0.12;     ///< of contacts that are told apart [m]
    double smoothing = 0.3;       ///< α
    int patience = 3;             ///< [pictures]

    template <class F>
    void Parameters(F&& f) {
      f("view", view);
      f("noise", noise);
      f("period", period);
      f("margin", margin, "m", kNotNegative);
      f("reach", reach, "m", kPositive);
      f("band", band, "m", kPositive);
      f("least_points", least_points, "", Between(1, 1e6));
      f("contacts", contacts, "", Between(1, kMaxContacts));
      f("separation", separation, "m", kPositive);
      f("smoothing", smoothing, "", Between(1e-3, 1));
      f("patience", patience, "", Between(1, 1e6));
    }
  };

  explicit ContactLocalization(const Options& o);

  Input<DepthImage> image;
  Input<RobotDynamics> dynamics;  ///< at the measured joint angles
  Input<bool> touched;            ///< true if not connected
  Input<int> isolated;            ///< index of a link; −1, if not connected: nothing is known
  Output<Contacts> contacts;
  Output<ContactSight> sight;

 private:
  struct Known {
    Contacts contacts;
    ContactSight sight;
    std::array<int, kMaxContacts> missed{};  // pictures in a row, of each contact
    double picture = -1;                     // when the last one was taken

    template <class Visitor>
    void Fields(Visitor&& f) {
      f("contacts", contacts, "");
      f("sight", sight, "");
      f("missed", missed, "");
      f("picture", picture, "s");
    }
  };
  struct Workspace {
    SelfFilter::View view;
    TouchingPoints::Workspace points;
  };

  Known Look(Workspace& w, const Known& last, double t, const DepthImage& image,
             const RobotDynamics& d, bool touched, int isolated) const;
  void Follow(Known& known, TouchingPoints::Places& places, const SelfFilter::View& view,
              const RobotDynamics& d) const;
  void Begin(Known& known, const TouchingPoints::Places& places, const RobotDynamics& d,
             int isolated) const;
  void End(Known& known, const SelfFilter::View& view, const RobotDynamics& d) const;
  void MoveTo(ContactForce& contact, const TouchingPoints::Place& place,
              const SelfFilter::View& view, const RobotDynamics& d) const;
  bool IsBehind(int link, int isolated) const;
  Pose InCamera(int link, const RobotDynamics& d) const;

  const RobotModel model_;
  const Pinhole view_;
  const SelfFilter filter_;
  const TouchingPoints points_;
  const double h_, separation_, smoothing_;
  const int contacts_, patience_;
  Output<Known> known_;
  Scratch<Workspace> workspace_;
};

}  // namespace pliant
