// SPDX-License-Identifier: Apache-2.0
// Sunder from C#: scenes, simulations and all that a host does to a live body. Each function's rules
// stand in sunder.h. Units: mm, N, MPa. Arrays are dense, row by row; a wrong call throws Error with
// the library's sentence.
using System;
using System.Collections.Generic;
using System.Runtime.InteropServices;
using System.Text;

namespace Sunder {

public class Error : Exception {
  /// <summary>SUNDER_ERROR_*: 2 order, 3 input, 10 value, 11 busy and so on.</summary>
  public readonly int Status;

  Error(int status, string text) : base(text) { Status = status; }

  internal static void Check(int status) {
    if (status == 0) return;
    IntPtr text = Native.sunder_last_error();
    var bytes = new List<byte>();
    for (int i = 0; Marshal.ReadByte(text, i) != 0; ++i) bytes.Add(Marshal.ReadByte(text, i));
    throw new Error(status, Encoding.UTF8.GetString(bytes.ToArray()));
  }
}

/// <summary>A handle of the library; closed by Dispose, or at last by the collector.</summary>
public abstract class Handle : IDisposable {
  internal IntPtr handle;

  internal static UIntPtr Size(Array values) {
    return values == null ? UIntPtr.Zero : (UIntPtr)values.Length;
  }
  internal abstract int Close(IntPtr of);

  public void Dispose() {
    if (handle == IntPtr.Zero) return;
    int status = Close(handle);
    if (status == 11) Error.Check(status);  // in use: it is still there
    handle = IntPtr.Zero;
    GC.SuppressFinalize(this);
  }
  ~Handle() {
    if (handle != IntPtr.Zero) Close(handle);
  }
}

/// <summary>Nodes: by ids, in a box or in a ball, or of faces, three ids each.</summary>
public struct Nodes {
  internal int kind;
  internal int[] ids;
  internal double[] min, max;
  internal double radius;

  public static Nodes Ids(params int[] ids) { return new Nodes { kind = 0, ids = ids }; }
  public static Nodes Box(double[] min, double[] max) {
    return new Nodes { kind = 1, min = min, max = max };
  }
  public static Nodes Ball(double[] centre, double radius) {
    return new Nodes { kind = 2, min = centre, radius = radius };
  }
  public static Nodes Faces(params int[] ids) { return new Nodes { kind = 3, ids = ids }; }

  /// <summary>What the library reads until `pinned` is freed.</summary>
  internal NativeSelection Pin(out GCHandle pinned) {
    var numbers = ids ?? new int[0];
    pinned = GCHandle.Alloc(numbers, GCHandleType.Pinned);
    return new NativeSelection {
      kind = kind, ids = pinned.AddrOfPinnedObject(), idCount = Handle.Size(numbers),
      min = min ?? new double[3], max = max ?? new double[3], radius = radius
    };
  }
}

public enum Law { Linear = 0, Corotated = 1, NeoHookean = 2, SaintVenantKirchhoff = 3 }
public enum Model { None = 0, A = 1, B = 2, P = 3 }
/// <summary>Of a Rupture: (Cause)rupture.cause.</summary>
public enum Cause { Mss = 0, Sif = 1, Preset = 2, Script = 3, Principal = 4, Interface = 5 }
public enum Backend { Auto = 0, Cpu = 1, Vulkan = 2 }

/// <summary>The model and what acts on it.</summary>
public sealed class Scene : Handle {
  public Scene() { Error.Check(Native.sunder_scene_create(out handle)); }
  internal override int Close(IntPtr of) { return Native.sunder_scene_destroy(of); }

  /// <summary>nodes (n x 3) [mm], tetrahedra (t x 4) in either orientation: Unity's left-handed ones
  /// are turned, with a warning. materialOf: one index each, or null.</summary>
  public void SetMesh(double[] nodes, int[] tets, int[] materialOf = null) {
    Error.Check(Native.sunder_scene_set_mesh(handle, nodes, Size(nodes), tets, Size(tets), materialOf,
                                             Size(materialOf)));
  }

  static NativeMaterial Material() {
    return new NativeMaterial { structSize = (uint)Marshal.SizeOf(typeof(NativeMaterial)) };
  }
  int Add(NativeMaterial material) {
    int index;
    Error.Check(Native.sunder_scene_add_material(handle, ref material, out index));
    return index;
  }
  /// <summary>young [MPa]; yield [MPa], 0: unbreakable; density [t/mm^3].</summary>
  public int AddMaterial(double young, double poisson, double yield = 0, Law law = Law.Linear,
                         double toughness = 0, double density = 0) {
    var material = Material();
    material.young = young;
    material.poisson = poisson;
    material.yield = yield;
    material.law = (int)law;
    material.toughness = toughness;
    material.density = density;
    return Add(material);
  }
  /// <summary>A tissue by name (docs/tissues.md).</summary>
  public int AddMaterial(string preset) {
    var material = Material();
    Error.Check(Native.sunder_material_preset(preset, ref material));
    return Add(material);
  }

  /// <summary>Faces that elements of two materials share part by a law: strength [MPa] and energy
  /// [N/mm] in tension, shearRatio of that strength in shear. Adds nodes and elements.</summary>
  public void AddInterface(int firstMaterial, int secondMaterial, double strength, double energy,
                           double shearRatio = 1) {
    Error.Check(Native.sunder_scene_add_interface(handle, firstMaterial, secondMaterial, strength,
                                                  energy, shearRatio));
  }

  /// <summary>Held nodes; axes: 1 x, 2 y, 4 z.</summary>
  public void AddSupport(Nodes nodes, uint axes = 7) {
    GCHandle pinned;
    var support = new NativeSupport { structSize = (uint)Marshal.SizeOf(typeof(NativeSupport)),
                                      axes = axes, nodes = nodes.Pin(out pinned) };
    int status = Native.sunder_scene_add_support(handle, ref support);
    pinned.Free();
    Error.Check(status);
  }

  int AddInstrument(int kind, Nodes nodes, double[] value, uint axes, bool rigid) {
    GCHandle pinned;
    var instrument = new NativeInstrument {
      structSize = (uint)Marshal.SizeOf(typeof(NativeInstrument)), kind = kind,
      nodes = nodes.Pin(out pinned), value = value, axes = axes, at = new double[3],
      ramp = new double[2], turn = new double[3], rigid = rigid ? 1 : 0
    };
    int index;
    int status = Native.sunder_scene_add_instrument(handle, ref instrument, out index);
    pinned.Free();
    Error.Check(status);
    return index;
  }
  /// <summary>A force [N] in equal parts on nodes.</summary>
  public int AddForce(Nodes nodes, double[] force) {
    return AddInstrument(0, nodes, force, 7, false);
  }
  /// <summary>A grip that moves nodes [mm] for as long as the simulation lives.</summary>
  public int AddGrip(Nodes nodes, double[] displacement, uint axes = 7, bool rigid = false) {
    return AddInstrument(1, nodes, displacement, axes, rigid);
  }

  /// <summary>split: cracks open faces and destroy nothing (model B).</summary>
  public void SetFracture(Model model, int maxEvents = 10000, bool split = false) {
    var options = new NativeFracture {
      structSize = (uint)Marshal.SizeOf(typeof(NativeFracture)), model = (int)model, alpha = 1e-6,
      maxEvents = maxEvents, planeNormal = new double[3], crack = split ? 1 : 0
    };
    Error.Check(Native.sunder_scene_set_fracture(handle, ref options));
  }
  public void SetSolver(Backend backend, double tolerance = 1e-4, double maxMs = 0) {
    var options = new NativeSolver {
      structSize = (uint)Marshal.SizeOf(typeof(NativeSolver)), backend = (int)backend, device = -1,
      tolerance = tolerance, maxMs = maxMs
    };
    Error.Check(Native.sunder_scene_set_solver(handle, ref options));
  }
  public void SetSteps(int steps) { Error.Check(Native.sunder_scene_set_steps(handle, steps)); }
  /// <summary>A host may grasp, remove and cut, whatever breaks by itself.</summary>
  public void SetLive(bool live = true) {
    Error.Check(Native.sunder_scene_set_live(handle, live ? 1 : 0));
  }
}

/// <summary>A body that is computed; one thread at a time, but for Cancel and Dispose.</summary>
public sealed class Simulation : Handle {
  readonly int nodes, tets;

  /// <summary>nodes, tets: how many the scene's mesh has. Interfaces add to them.</summary>
  public Simulation(Scene scene, int nodes, int tets) {
    Error.Check(Native.sunder_simulation_create(scene.handle, IntPtr.Zero, out handle));
    this.nodes = nodes;
    this.tets = tets;
    int interfaces;
    Error.Check(Native.sunder_simulation_interface_count(handle, out interfaces));
    if (interfaces == 0) return;
    NativeBody body = Body();
    this.nodes = body.nodeCount;
    this.tets = body.tetCount;
  }
  NativeBody Body() {
    var body = new NativeBody { structSize = (uint)Marshal.SizeOf(typeof(NativeBody)) };
    Error.Check(Native.sunder_simulation_body(handle, ref body));
    return body;
  }
  internal override int Close(IntPtr of) { return Native.sunder_simulation_destroy(of); }

  static Step Empty() { return new Step { structSize = (uint)Marshal.SizeOf(typeof(Step)) }; }
  public Step Step() {
    var step = Empty();
    Error.Check(Native.sunder_simulation_step(handle, ref step));
    return step;
  }
  public Step StepWithin(double maxMs) {
    var step = Empty();
    Error.Check(Native.sunder_simulation_step_within(handle, maxMs, ref step));
    return step;
  }
  public void WarmUp() { Error.Check(Native.sunder_simulation_warm_up(handle)); }
  public void Cancel() { Error.Check(Native.sunder_simulation_cancel(handle)); }
  public void Drive(int instrument, double[] value) {
    Error.Check(Native.sunder_simulation_drive(handle, instrument, Three(value)));
  }
  public void Turn(int instrument, double[] degrees) {
    Error.Check(Native.sunder_simulation_turn(handle, instrument, Three(degrees)));
  }

  /// <summary>(nodes x 3) [mm]</summary>
  public double[] Displacement() {
    var values = new double[3 * nodes];
    Error.Check(Native.sunder_simulation_displacement(handle, values, Size(values)));
    return values;
  }
  public bool[] Destroyed() {
    var values = new byte[tets];
    Error.Check(Native.sunder_simulation_destroyed(handle, values, Size(values)));
    return Array.ConvertAll(values, v => v != 0);
  }
  public Rupture[] Ruptures() {
    int count;
    Error.Check(Native.sunder_simulation_event_count(handle, out count));
    var all = new Rupture[count];
    for (int i = 0; i < count; ++i) {
      all[i].structSize = (uint)Marshal.SizeOf(typeof(Rupture));
      Error.Check(Native.sunder_simulation_event_at(handle, i, ref all[i]));
    }
    return all;
  }
  /// <summary>In the order in which they were added.</summary>
  public Interface[] Interfaces() {
    int count;
    Error.Check(Native.sunder_simulation_interface_count(handle, out count));
    var all = new Interface[count];
    for (int i = 0; i < count; ++i) {
      all[i].structSize = (uint)Marshal.SizeOf(typeof(Interface));
      Error.Check(Native.sunder_simulation_interface_at(handle, i, ref all[i]));
    }
    return all;
  }

  // ---- the body as interfaces make it, or as split cracks leave it

  /// <summary>(nodes x 3) undeformed [mm]</summary>
  public double[] BodyNodes() {
    var values = new double[3 * Body().nodeCount];
    Error.Check(Native.sunder_simulation_body_nodes(handle, values, Size(values)));
    return values;
  }
  /// <summary>(tets x 4)</summary>
  public int[] BodyCorners() {
    var values = new int[4 * Body().tetCount];
    Error.Check(Native.sunder_simulation_body_corners(handle, values, Size(values)));
    return values;
  }
  /// <summary>(nodes): which of the mesh's nodes each was made of.</summary>
  public int[] BodyParents() {
    var values = new int[Body().nodeCount];
    Error.Check(Native.sunder_simulation_body_parents(handle, values, Size(values)));
    return values;
  }

  // ---- grips, pushes, elements

  /// <summary>The library reads as many.</summary>
  internal static double[] Values(double[] values, int count) {
    if (values != null && values.Length == count) return values;
    throw new ArgumentException("it takes " + count + " numbers");
  }
  static double[] Three(double[] values) { return Values(values, 3); }

  public int Grasp(int[] nodes, bool rigid = false) {
    int grip;
    Error.Check(Native.sunder_simulation_grasp(handle, nodes, Size(nodes), rigid ? 1 : 0, out grip));
    return grip;
  }
  public int Grasp(double[] near, double radius, bool rigid = false) {
    int grip;
    Error.Check(Native.sunder_simulation_grasp_near(handle, Three(near), radius, rigid ? 1 : 0,
                                                    out grip));
    return grip;
  }
  public int[] HeldNodes(int grip) {
    UIntPtr count;
    Error.Check(Native.sunder_simulation_held_nodes(handle, grip, null, UIntPtr.Zero, out count));
    var held = new int[(int)count];
    Error.Check(Native.sunder_simulation_held_nodes(handle, grip, held, Size(held), out count));
    return held;
  }
  public double[] GripPlace(int grip) {
    var place = new double[3];
    Error.Check(Native.sunder_simulation_grip_place(handle, grip, place));
    return place;
  }
  /// <summary>quaternion: x, y, z, w; null: no rotation.</summary>
  public void Pose(int grip, double[] position, double[] quaternion = null) {
    if (quaternion != null) Values(quaternion, 4);
    Error.Check(Native.sunder_simulation_pose(handle, grip, Three(position), quaternion));
  }
  public void Wrench(int grip, double[] force, double[] torque) {
    Error.Check(Native.sunder_simulation_wrench(handle, grip, Three(force), Three(torque)));
  }
  public void Release(int grip) { Error.Check(Native.sunder_simulation_release(handle, grip)); }
  public int Push(int[] nodes, double[] force) {
    int push;
    Error.Check(Native.sunder_simulation_push(handle, nodes, Size(nodes), Three(force), out push));
    return push;
  }
  public void Move(int push, int[] nodes, double[] force) {
    Error.Check(Native.sunder_simulation_move(handle, push, nodes, Size(nodes), Three(force)));
  }
  public void Drop(int push) { Error.Check(Native.sunder_simulation_drop(handle, push)); }
  public void Remove(params int[] elements) {
    Error.Check(Native.sunder_simulation_remove(handle, elements, Size(elements)));
  }
  /// <summary>swept: triangles (t x 3 x 3) [mm]. Returns how many elements are gone.</summary>
  public int Cut(double[] swept) {
    int removed;
    Error.Check(Native.sunder_simulation_cut(handle, swept, Size(swept), out removed));
    return removed;
  }
  /// <summary>Elements that may soon be removed, cut or grasped, in place of those named before.
  /// No result changes.</summary>
  public void Prepare(params int[] elements) {
    Error.Check(Native.sunder_simulation_prepare(handle, elements, Size(elements)));
  }
  /// <summary>The same of those within a radius [mm] of a place now. Returns how many.</summary>
  public int Prepare(double[] near, double radius) {
    int count;
    Error.Check(Native.sunder_simulation_prepare_near(handle, Three(near), radius, out count));
    return count;
  }

  // ---- back and forth

  public void KeepHistory(int quick = 100) {
    Error.Check(Native.sunder_simulation_keep_history(handle, quick));
  }
  public void History(out int undos, out int redos) {
    Error.Check(Native.sunder_simulation_history(handle, out undos, out redos));
  }
  /// <summary>Returns how many events went.</summary>
  public int Undo(int actions = 1) {
    int events, replayed;
    Error.Check(Native.sunder_simulation_undo(handle, actions, out events, out replayed));
    return events;
  }
  public int Redo(int actions = 1) {
    int events;
    Error.Check(Native.sunder_simulation_redo(handle, actions, out events));
    return events;
  }
  public int Save() {
    int mark;
    Error.Check(Native.sunder_simulation_save(handle, out mark));
    return mark;
  }
  public void Restore(int mark) {
    int replayed;
    Error.Check(Native.sunder_simulation_restore(handle, mark, out replayed));
  }
  public void Forget(int mark) { Error.Check(Native.sunder_simulation_forget(handle, mark)); }
  public byte[] Store() {
    UIntPtr length;
    Error.Check(Native.sunder_simulation_store(handle, null, UIntPtr.Zero, out length));
    var bytes = new byte[(int)length];
    Error.Check(Native.sunder_simulation_store(handle, bytes, Size(bytes), out length));
    return bytes;
  }
  public void Load(byte[] history) {
    Error.Check(Native.sunder_simulation_load(handle, history, Size(history)));
  }

  // ---- drawing

  /// <summary>Follows what has changed; triangles in places from triangleCount on are gone.</summary>
  public ulong Surface(out int triangleCount, out int nodeCount) {
    var surface = new NativeSurface { structSize = (uint)Marshal.SizeOf(typeof(NativeSurface)) };
    Error.Check(Native.sunder_simulation_surface(handle, ref surface));
    triangleCount = surface.triangleCount;
    nodeCount = surface.nodeCount;
    return surface.version;
  }
  public Triangle[] SurfaceChanges(ulong since) {
    UIntPtr count;
    Error.Check(
        Native.sunder_simulation_surface_changes(handle, since, null, UIntPtr.Zero, out count));
    var changed = new Triangle[(int)count];
    Error.Check(Native.sunder_simulation_surface_changes(handle, since, changed, Size(changed),
                                                         out count));
    return changed;
  }
  /// <summary>(nodeCount x 3) each: places [mm] and unit normals; either may be null.</summary>
  public void SurfacePoints(float[] places, float[] normals) {
    Error.Check(Native.sunder_simulation_surface_points(handle, places, normals,
                                                        Size(places ?? normals)));
  }
  public void SetSkin(double[] vertices) {
    Error.Check(Native.sunder_simulation_set_skin(handle, vertices, Size(vertices)));
  }
  public void Skin(float[] places, byte[] lives = null) {
    if (lives != null && lives.Length != places.Length / 3) {
      throw new ArgumentException("lives takes one byte a vertex");
    }
    Error.Check(Native.sunder_simulation_skin(handle, places, Size(places), lives));
  }
}

/// <summary>Forces of the grips between steps, for a thread of its own.</summary>
public sealed class Grips : Handle {
  public Grips(Simulation simulation) {
    Error.Check(Native.sunder_grips_create(simulation.handle, out handle));
  }
  internal override int Close(IntPtr of) { return Native.sunder_grips_destroy(of); }

  /// <summary>Of the scene's own grips, (instruments x 3) each.</summary>
  public void Forces(double[] displacements, double[] forces) {
    if (displacements == null || forces == null || displacements.Length != forces.Length) {
      throw new ArgumentException("displacements and forces have the same size");
    }
    Error.Check(Native.sunder_grips_forces(handle, displacements, forces, Size(forces)));
  }
  /// <summary>Where a new solution changes forces they go there within so many ms.</summary>
  public void Blend(double ms) { Error.Check(Native.sunder_grips_blend(handle, ms)); }

  /// <summary>Fills force and torque of each hand; no force where there is no solution, and once the
  /// simulation is gone, which is no error: the state says so.</summary>
  public Felt Feel(Hand[] hands) {
    var felt = new Felt { structSize = (uint)Marshal.SizeOf(typeof(Felt)) };
    int status = Native.sunder_grips_feel(handle, null, null, UIntPtr.Zero, hands, Size(hands),
                                          ref felt);
    bool told = (status == 2 && felt.state == FeltState.Waiting) ||
                (status == 7 && felt.state == FeltState.Gone);
    if (!told) Error.Check(status);
    return felt;
  }
}

/// <summary>Fields of the last finished step, for a thread of its own.</summary>
public sealed class Frames : Handle {
  public const uint Displacement = 1, Stress = 2, YieldRatio = 4, Destroyed = 8;

  public Frames(Simulation simulation, uint fields, int[] nodes = null) {
    Error.Check(Native.sunder_frames_create(simulation.handle, fields, nodes, Size(nodes),
                                            out handle));
  }
  internal override int Close(IntPtr of) { return Native.sunder_frames_destroy(of); }

  /// <summary>Takes the last one; returns the step that it is the end of, -1 before the first.
  /// </summary>
  public int Take(out int nodeCount) {
    var frame = new NativeFrame { structSize = (uint)Marshal.SizeOf(typeof(NativeFrame)) };
    Error.Check(Native.sunder_frames_take(handle, ref frame));
    nodeCount = frame.nodeCount;
    return frame.step;
  }
  public void ReadDisplacement(double[] values) {
    Error.Check(Native.sunder_frames_displacement(handle, values, Size(values)));
  }
  public void ReadStress(double[] values) {
    Error.Check(Native.sunder_frames_stress(handle, values, Size(values)));
  }
  public void ReadYieldRatio(double[] values) {
    Error.Check(Native.sunder_frames_yield_ratio(handle, values, Size(values)));
  }
  public void ReadDestroyed(byte[] values) {
    Error.Check(Native.sunder_frames_destroyed(handle, values, Size(values)));
  }
}

}
