// SPDX-License-Identifier: Apache-2.0
// A live body as a component of Unity: it is computed in FixedUpdate, drawn by a mesh of its own, and
// grasped, cut and undone by other scripts. Lengths of the scene are mm.
//
// Unity's axes are left-handed. The body is computed with its coordinates as they stand: mirrored,
// which no force and no strain notices; tetrahedra are turned by the library, the triangles of its
// surface, anticlockwise in right-handed axes, come out clockwise as Unity wants them, and
// quaternions mean the same rotation of the same numbers.
using System.Collections.Generic;
using UnityEngine;

namespace Sunder {

[RequireComponent(typeof(MeshFilter))]
public class SunderBody : MonoBehaviour {
  public Vector3[] nodes;
  public int[] tetrahedra;
  public int[] heldNodes;
  public double young = 0.03, poisson = 0.45, yieldStress = 0.02;  // MPa
  public double maxMs = 8;  // of a step, between ruptures
  public string failure = "";  // why it stands still; empty: it does not

  Simulation simulation;
  Mesh mesh;
  ulong drawn;
  readonly List<int> corners = new List<int>();
  float[] places, normals;
  Vector3[] vertices, directions;

  public Simulation Simulation { get { return simulation; } }

  void Start() {
    var coordinates = new double[3 * nodes.Length];
    for (int n = 0; n < nodes.Length; ++n) {
      coordinates[3 * n] = nodes[n].x;
      coordinates[3 * n + 1] = nodes[n].y;
      coordinates[3 * n + 2] = nodes[n].z;
    }
    Try(() => {
      using (var scene = new Scene()) {
        scene.SetMesh(coordinates, tetrahedra);
        scene.AddMaterial(young, poisson, yieldStress);
        scene.AddSupport(Nodes.Ids(heldNodes));
        scene.SetFracture(Model.A);
        scene.SetLive();
        scene.SetSteps(int.MaxValue);
        simulation = new Simulation(scene, nodes.Length, tetrahedra.Length / 4);
      }
      simulation.KeepHistory();
      simulation.WarmUp();
    });
    mesh = new Mesh();
    GetComponent<MeshFilter>().mesh = mesh;
  }

  void FixedUpdate() {
    if (simulation != null && failure == "") Try(() => simulation.StepWithin(maxMs));
  }

  void Update() {
    if (simulation != null) Try(Draw);
  }

  void OnDestroy() {
    if (simulation != null) simulation.Dispose();
    simulation = null;
  }

  void Draw() {
    int triangleCount, nodeCount;
    ulong version = simulation.Surface(out triangleCount, out nodeCount);
    if (version != drawn) {
      while (corners.Count < 3 * triangleCount) corners.Add(0);
      foreach (Triangle t in simulation.SurfaceChanges(drawn)) {
        if (t.place >= triangleCount) continue;
        corners[3 * t.place] = t.a;
        corners[3 * t.place + 1] = t.b;
        corners[3 * t.place + 2] = t.c;
      }
      corners.RemoveRange(3 * triangleCount, corners.Count - 3 * triangleCount);
    }
    if (places == null || places.Length != 3 * nodeCount) {
      places = new float[3 * nodeCount];
      normals = new float[3 * nodeCount];
      vertices = new Vector3[nodeCount];
      directions = new Vector3[nodeCount];
    }
    simulation.SurfacePoints(places, normals);
    for (int n = 0; n < nodeCount; ++n) {
      vertices[n] = new Vector3(places[3 * n], places[3 * n + 1], places[3 * n + 2]);
      directions[n] = new Vector3(normals[3 * n], normals[3 * n + 1], normals[3 * n + 2]);
    }
    mesh.vertices = vertices;
    mesh.normals = directions;
    if (version != drawn) mesh.triangles = corners.ToArray();
    drawn = version;
  }

  /// <summary>All nodes within a radius, as one solid; -1: there are none.</summary>
  public int Grasp(Vector3 place, float radius) {
    int grip = -1;
    Try(() => grip = simulation.Grasp(Numbers(place), radius, true), false);
    return grip;
  }
  public void Pose(int grip, Vector3 place, Quaternion rotation) {
    Try(() => simulation.Pose(grip, Numbers(place),
                              new double[] { rotation.x, rotation.y, rotation.z, rotation.w }));
  }
  public void Release(int grip) { Try(() => simulation.Release(grip)); }
  public void Undo() { Try(() => simulation.Undo(), false); }
  /// <summary>What a blade's edge from a to b passes on its way to c and d.</summary>
  public int Cut(Vector3 a, Vector3 b, Vector3 c, Vector3 d) {
    var swept = new List<double>();
    foreach (Vector3 p in new[] { a, b, c, b, d, c }) swept.AddRange(Numbers(p));
    int removed = 0;
    Try(() => removed = simulation.Cut(swept.ToArray()), false);
    return removed;
  }

  static double[] Numbers(Vector3 p) { return new double[] { p.x, p.y, p.z }; }

  /// <summary>An error is logged; one that `stops` ends the steps.</summary>
  void Try(System.Action what, bool stops = true) {
    try {
      what();
    } catch (Error error) {
      Debug.LogWarning("Sunder: " + error.Message);
      if (stops) failure = error.Message;
    }
  }
}

}
