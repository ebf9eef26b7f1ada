// SPDX-License-Identifier: Apache-2.0
// The live interface from C#: a column of three cubes, held below, by hand values; then the component
// of Unity against stubs of Unity's types.
using System;
using System.Linq;
using System.Runtime.InteropServices;
using Sunder;
using UnityEngine;

static class Live {
  static void Expect(bool holds, string what) {
    if (!holds) throw new Exception("not so: " + what);
  }
  static void Near(double a, double b, string what) {
    if (!(Math.Abs(a - b) <= 1e-8)) throw new Exception(what + ": " + a + ", not " + b);
  }
  static void Fails(int status, Action what) {
    try {
      what();
    } catch (Error error) {
      Expect(error.Status == status && error.Message != "", "status " + error.Status);
      return;
    }
    throw new Exception("no error of status " + status);
  }

  static double[] Nodes() {
    return Enumerable.Range(0, 48).Select(i => (double)(
        i % 3 == 0 ? i / 3 % 2 : i % 3 == 1 ? i / 6 % 2 : i / 12)).ToArray();
  }
  /// Three cubes of six tetrahedra; `left`: as in axes of the other hand.
  static int[] Tets(bool left) {
    int[] six = { 0, 1, 3, 7, 0, 3, 2, 7, 0, 2, 6, 7, 0, 6, 4, 7, 0, 4, 5, 7, 0, 5, 1, 7 };
    var tets = Enumerable.Range(0, 72).Select(i => six[i % 24] + 4 * (i / 24)).ToArray();
    for (int t = 0; left && t < tets.Length; t += 4) {
      int first = tets[t];
      tets[t] = tets[t + 1];
      tets[t + 1] = first;
    }
    return tets;
  }

  static Simulation Column(bool left) {
    using (var scene = new Scene()) {
      scene.SetMesh(Nodes(), Tets(left));
      scene.AddMaterial(8, 0);
      scene.AddSupport(Sunder.Nodes.Ids(0, 1, 2, 3));
      scene.SetSolver(Backend.Cpu);
      scene.SetLive();
      scene.SetSteps(1000);
      return new Simulation(scene, 16, 18);
    }
  }

  static readonly int[] Top = { 12, 13, 14, 15 };

  /// Hooke, Poisson's ratio 0: the face is 1 mm^2 and 3 mm high, 8 MPa: .3 mm takes .8 N.
  static void Grip(bool left) {
    using (Simulation s = Column(left))
    using (var grips = new Grips(s))
    using (var frames = new Frames(s, Frames.Displacement | Frames.Destroyed)) {
      s.WarmUp();
      s.KeepHistory();
      int start = s.Save();
      int grip = s.Grasp(Top, true);
      Expect(s.HeldNodes(grip).SequenceEqual(Top), "held nodes");
      Near(s.GripPlace(grip)[2], 3, "place");
      var hands = new[] { new Hand { grip = grip, x = 0.5, y = 0.5, z = 3.6, qw = 1 } };
      Expect(grips.Feel(hands).state == FeltState.Waiting, "no solution yet");
      s.Pose(grip, new[] { 0.5, 0.5, 3.3 }, new double[] { 0, 0, 0, 2 });
      Expect(s.Step().step == 0, "step");
      double[] force = new double[3], torque = new double[3];
      s.Wrench(grip, force, torque);
      Near(force[2], 0.8, "force");
      Near(torque[0], 0, "torque");
      Near(s.Displacement()[3 * 15 + 2], 0.3, "displacement");
      grips.Blend(5);
      Felt felt = grips.Feel(hands);
      Expect(felt.state == FeltState.Live && felt.step == 0 && hands[0].held == 1, "felt");
      Near(hands[0].forceZ, 1.6, "force where the hand is");
      Fails(10, () => grips.Blend(-1));
      int nodeCount;
      Expect(frames.Take(out nodeCount) == 0 && nodeCount == 16, "frame");
      var u = new double[48];
      frames.ReadDisplacement(u);
      Near(u[47], 0.3, "frame's displacement");
      Fails(2, () => frames.ReadStress(new double[108]));

      int other = s.Grasp(new[] { 0, 0, 2.2 }, 0.3);
      Expect(s.HeldNodes(other).Single() == 8, "near");
      Fails(2, () => s.Grasp(new[] { 8 }));
      s.Release(other);
      s.Release(grip);
      Expect(grips.Feel(hands).state == FeltState.Live && hands[0].held == 0, "let go");
      int push = s.Push(Top, new[] { 0, 0, 0.4 });
      s.Move(push, Top, new[] { 0, 0, 0.8 });
      s.StepWithin(50);
      // In equal parts, not by area: near the .3 mm of an even pull, not at it.
      Expect(Math.Abs(s.Displacement()[47] - 0.3) < 0.03, "pushed");
      s.Drop(push);

      s.Prepare(0);
      Expect(s.Prepare(new[] { 0.5, 0.5, 0.5 }, 0.9) > 1, "prepared");
      s.Remove(0);
      Expect(s.Destroyed().Count(d => d) == 1 && s.Ruptures().Single().element == 0, "removed");
      int triangles, nodes;
      ulong version = s.Surface(out triangles, out nodes);
      Expect(s.SurfaceChanges(0).Length == triangles, "triangles");
      var places = new float[3 * nodes];
      s.SurfacePoints(places, new float[3 * nodes]);
      Expect(s.Cut(new double[] { -1, -1, 2.5, 2, -1, 2.5, -1, 4, 2.5 }) > 0, "cut");
      Expect(s.Surface(out triangles, out nodes) != version, "version");
      Expect(s.SurfaceChanges(version).Length > 0, "changes");
      s.SetSkin(new[] { 0.5, 0.5, 0.5 });
      s.Skin(new float[3], new byte[1]);

      int undos, redos;
      s.History(out undos, out redos);
      Expect(undos > 0 && redos == 0, "history");
      Expect(s.Undo() > 0 && s.Redo() > 0, "undo, redo");
      byte[] stored = s.Store();
      double[] here = s.Displacement();
      s.Restore(start);
      Expect(!s.Destroyed().Any(d => d), "restored");
      s.Load(stored);
      Expect(s.Displacement().SequenceEqual(here), "the same bits");
      stored[20] ^= 1;
      Fails(3, () => s.Load(stored));
      s.Forget(start);
      Fails(10, () => s.Restore(start));
      s.Dispose();
      Expect(grips.Feel(hands).state == FeltState.Gone, "gone");
      Fails(7, () => s.Step());
    }
  }

  /// The upper cube parts from the two below it: 1 mm^2, strength .2 MPa, energy .05 N/mm.
  static void Parting() {
    using (var scene = new Scene()) {
      scene.SetMesh(Nodes(), Tets(false), Enumerable.Range(0, 18).Select(t => t / 12).ToArray());
      scene.AddMaterial(8, 0, law: Law.NeoHookean);
      scene.AddMaterial(8, 0, law: Law.NeoHookean);
      scene.AddSupport(Sunder.Nodes.Ids(0, 1, 2, 3));
      scene.AddGrip(Sunder.Nodes.Faces(12, 13, 15, 12, 15, 14), new[] { 0, 0, 0.8 });
      scene.AddInterface(0, 1, 0.2, 0.05);
      scene.SetFracture(Model.A);
      scene.SetSolver(Backend.Cpu);
      Fails(10, () => scene.AddInterface(0, 2, 0.2, 0.05));
      using (var s = new Simulation(scene, 16, 18)) {
        Expect(s.BodyNodes().Length == 3 * 20 && s.BodyCorners().Length == 4 * 24, "body");
        Expect(s.BodyParents().Skip(16).All(n => n >= 8 && n < 12), "parents");
        Expect(s.Interfaces().Single().parted == 0, "whole");
        s.Step();
        Interface state = s.Interfaces().Single();
        Near(state.parted, state.area, "parted area");
        Expect(Math.Abs(state.area - 1) < 1e-4, "area " + state.area);
        Expect(Math.Abs(state.spent - 0.05) < 0.001, "energy " + state.spent);
        Expect(s.Ruptures().Length == 6 && s.Ruptures().All(r => (Cause)r.cause == Cause.Interface),
               "cause");
        Near(s.Ruptures().Sum(r => r.energy), state.spent, "energy of the rows");
        Expect(s.Destroyed().Count(d => d) == 6 && s.Displacement().Length == 60, "arrays");
      }
    }
  }

  static void Component() {
    var body = new SunderBody {
      nodes = Enumerable.Range(0, 16).Select(n => new Vector3(
          (float)Nodes()[3 * n], (float)Nodes()[3 * n + 1], (float)Nodes()[3 * n + 2])).ToArray(),
      tetrahedra = Tets(true), heldNodes = new[] { 0, 1, 2, 3 }, young = 8, poisson = 0,
      yieldStress = 100
    };
    body.Send("Start");
    Expect(body.failure == "", body.failure);
    int grip = body.Grasp(new Vector3(0.5f, 0.5f, 3), 0.8f);
    Expect(grip >= 0 && body.Grasp(new Vector3(9, 9, 9), 0.1f) == -1, "grasp");
    body.Pose(grip, new Vector3(0.5f, 0.5f, 3.3f), new Quaternion(0, 0, 0, 1));
    body.Send("FixedUpdate");
    body.Send("Update");
    Mesh mesh = body.GetComponent<MeshFilter>().mesh;
    Expect(Math.Abs(mesh.vertices[15].z - 3.3) < 1e-5, "drawn where it is");
    Expect(mesh.triangles.Length == 3 * 28, "triangles " + mesh.triangles.Length / 3);
    // By Unity's rule, clockwise seen from outside: the normal of the corners' order points there.
    for (int t = 0; t < mesh.triangles.Length; t += 3) {
      Vector3 a = mesh.vertices[mesh.triangles[t]], b = mesh.vertices[mesh.triangles[t + 1]],
              c = mesh.vertices[mesh.triangles[t + 2]];
      double ux = b.x - a.x, uy = b.y - a.y, uz = b.z - a.z, vx = c.x - a.x, vy = c.y - a.y,
             vz = c.z - a.z;
      double out3 = (uy * vz - uz * vy) * (a.x + b.x + c.x - 1.5) +
                    (uz * vx - ux * vz) * (a.y + b.y + c.y - 1.5) +
                    (ux * vy - uy * vx) * (a.z + b.z + c.z - 4.95);
      Expect(out3 > 0, "outward");
    }
    Expect(body.Cut(new Vector3(-1, -1, 1.5f), new Vector3(-1, 3, 1.5f), new Vector3(3, -1, 1.5f),
                    new Vector3(3, 3, 1.5f)) > 0, "cut");
    body.Send("Update");
    Expect(mesh.triangles.Length != 3 * 28, "drawn cut");
    body.Undo();
    body.Send("Update");
    Expect(mesh.triangles.Length == 3 * 28, "drawn undone");
    body.Release(grip);
    body.Send("FixedUpdate");
    Expect(body.failure == "", body.failure);
    body.Send("OnDestroy");
  }

  static void Main(string[] arguments) {
    if (arguments.Length == 1 && arguments[0] == "--sizes") {
      foreach (var of in new[] { "Selection", "Material", "Support", "Instrument", "Fracture",
                                 "Solver", "Surface", "Frame" }) {
        Type type = typeof(Scene).Assembly.GetType("Sunder.Native" + of, true);
        Console.WriteLine(of + " " + Marshal.SizeOf(type));
      }
      foreach (var type in new[] { typeof(Triangle), typeof(Hand), typeof(Felt), typeof(Rupture),
                                   typeof(Interface) }) {
        Console.WriteLine(type.Name + " " + Marshal.SizeOf(type));
      }
      Type body = typeof(Scene).Assembly.GetType("Sunder.NativeBody", true);
      Console.WriteLine("Body " + Marshal.SizeOf(body));
      return;
    }
    Grip(false);
    Grip(true);
    Parting();
    Component();
    Console.WriteLine("c#: a live body, and Unity's component against stubs");
  }
}
