// SPDX-License-Identifier: Apache-2.0
// The declarations of sunder.h that the classes of Sunder.cs need. tests/consumer/csharp holds every
// name and every struct's size against the header.
using System;
using System.Runtime.InteropServices;

namespace Sunder {

[StructLayout(LayoutKind.Sequential)]
internal struct NativeSelection {
  public int kind, reserved;
  public IntPtr ids;
  public UIntPtr idCount;
  [MarshalAs(UnmanagedType.ByValArray, SizeConst = 3)] public double[] min;
  [MarshalAs(UnmanagedType.ByValArray, SizeConst = 3)] public double[] max;
  public double radius;
}

[StructLayout(LayoutKind.Sequential)]
internal struct NativeMaterial {
  public uint structSize, reserved;
  public double young, poisson, yield;
  public IntPtr name;
  public int law, reserved2;
  public double density, toughness, energy;
  public int volume, reserved3;
}

[StructLayout(LayoutKind.Sequential)]
internal struct NativeSupport {
  public uint structSize, axes;
  public NativeSelection nodes;
}

[StructLayout(LayoutKind.Sequential)]
internal struct NativeInstrument {
  public uint structSize;
  public int kind;
  public IntPtr name;
  public NativeSelection nodes;
  [MarshalAs(UnmanagedType.ByValArray, SizeConst = 3)] public double[] value;
  public uint axes;
  public int side, crack, hasRamp;
  [MarshalAs(UnmanagedType.ByValArray, SizeConst = 3)] public double[] at;
  [MarshalAs(UnmanagedType.ByValArray, SizeConst = 2)] public double[] ramp;
  [MarshalAs(UnmanagedType.ByValArray, SizeConst = 3)] public double[] turn;
  public int rigid, reserved;
}

[StructLayout(LayoutKind.Sequential)]
internal struct NativeFracture {
  public uint structSize;
  public int model;
  public double alpha;
  public int yieldMeasure, sigma0, crackLength, birth, sif, maxEvents, hasPlaneNormal, attribution;
  [MarshalAs(UnmanagedType.ByValArray, SizeConst = 3)] public double[] planeNormal;
  public double averaging;
  public int stress, crack, maxNewNodes, contact;
}

[StructLayout(LayoutKind.Sequential)]
internal struct NativeSolver {
  public uint structSize;
  public int backend, device, route, update, precision;
  public double tolerance;
  public int noPreparation, reserved;
  public double maxMs;
}

/// <summary>Report of a step; see sunder_step in sunder.h.</summary>
[StructLayout(LayoutKind.Sequential)]
public struct Step {
  internal uint structSize;
  public int step;
  public double loadFactor;
  public int events, destroyed, iterations, polished;
  public double compliance, residual, error, maxYieldRatio;
  public double msLoad, msSolve, msStress, msDecide, msUpdate, msTotal;
}

/// <summary>Why an element broke, or a crack grew.</summary>
[StructLayout(LayoutKind.Sequential)]
public struct Rupture {
  internal uint structSize;
  public int order, step, group, element, cause, crack, instrument;
  public double instrumentShare, loadFactor, ratio;
  public int hasSif, tip;
  public double k, kA, kB, kC, theta, reach, sigma0, beta, a, b, k1, k2, toughness, advance;
  public int lives, reserved;
  public double energy;
}

/// <summary>An interface and how far it has parted; see sunder_interface in sunder.h.</summary>
[StructLayout(LayoutKind.Sequential)]
public struct Interface {
  internal uint structSize;
  public int firstMaterial, secondMaterial, firstElement, elementCount, reserved;
  public double strength, energy, shearRatio, stiffness, opening, thickness, area, parted, spent;
}

[StructLayout(LayoutKind.Sequential)]
internal struct NativeBody {
  public uint structSize;
  public int version, nodeCount, tetCount, crackFaceCount, reserved;
}

[StructLayout(LayoutKind.Sequential)]
internal struct NativeSurface {
  public uint structSize;
  public int triangleCount, nodeCount, reserved;
  public ulong version;
}

/// <summary>Of a surface, in a place of its own.</summary>
[StructLayout(LayoutKind.Sequential)]
public struct Triangle {
  public int place, a, b, c, element, piece, opened;
}

/// <summary>Where a hand has a grip between two steps, and what it feels there.</summary>
[StructLayout(LayoutKind.Sequential)]
public struct Hand {
  public int grip, held;
  public double x, y, z;
  public double qx, qy, qz, qw;
  public double forceX, forceY, forceZ;
  public double torqueX, torqueY, torqueZ;
}

/// <summary>What forces come from.</summary>
[StructLayout(LayoutKind.Sequential)]
public struct Felt {
  internal uint structSize;
  public FeltState state;
  public ulong solution;
  public int step, reserved;
  public double ageMs, share;
}

public enum FeltState { Waiting = 0, Live = 1, Gone = 2, Overflow = 3 }

[StructLayout(LayoutKind.Sequential)]
internal struct NativeFrame {
  public uint structSize;
  public int step;
  public ulong number;
  public int nodeCount, reserved;
}

internal static class Native {
  const string Library = "sunder";

  [DllImport(Library)] public static extern IntPtr sunder_last_error();
  [DllImport(Library)]
  public static extern void sunder_version(out int major, out int minor, out int patch);

  [DllImport(Library)] public static extern int sunder_scene_create(out IntPtr scene);
  [DllImport(Library)] public static extern int sunder_scene_destroy(IntPtr scene);
  [DllImport(Library)]
  public static extern int sunder_scene_set_mesh(IntPtr scene, double[] nodes, UIntPtr nodesSize,
                                                 int[] tets, UIntPtr tetsSize, int[] materialOf,
                                                 UIntPtr materialOfSize);
  [DllImport(Library)]
  public static extern int sunder_material_preset(string preset, ref NativeMaterial material);
  [DllImport(Library)]
  public static extern int sunder_scene_add_material(IntPtr scene, ref NativeMaterial material,
                                                     out int index);
  [DllImport(Library)]
  public static extern int sunder_scene_add_support(IntPtr scene, ref NativeSupport support);
  [DllImport(Library)]
  public static extern int sunder_scene_add_instrument(IntPtr scene, ref NativeInstrument instrument,
                                                       out int index);
  [DllImport(Library)]
  public static extern int sunder_scene_add_interface(IntPtr scene, int firstMaterial,
                                                      int secondMaterial, double strength,
                                                      double energy, double shearRatio);
  [DllImport(Library)]
  public static extern int sunder_scene_set_fracture(IntPtr scene, ref NativeFracture options);
  [DllImport(Library)]
  public static extern int sunder_scene_set_solver(IntPtr scene, ref NativeSolver options);
  [DllImport(Library)] public static extern int sunder_scene_set_steps(IntPtr scene, int steps);
  [DllImport(Library)] public static extern int sunder_scene_set_live(IntPtr scene, int live);

  [DllImport(Library)]
  public static extern int sunder_simulation_create(IntPtr scene, IntPtr callbacks, out IntPtr made);
  [DllImport(Library)] public static extern int sunder_simulation_destroy(IntPtr simulation);
  [DllImport(Library)] public static extern int sunder_simulation_cancel(IntPtr simulation);
  [DllImport(Library)]
  public static extern int sunder_simulation_step(IntPtr simulation, ref Step step);
  [DllImport(Library)]
  public static extern int sunder_simulation_drive(IntPtr simulation, int instrument, double[] value);
  [DllImport(Library)]
  public static extern int sunder_simulation_turn(IntPtr simulation, int instrument, double[] turn);
  [DllImport(Library)]
  public static extern int sunder_simulation_displacement(IntPtr simulation, double[] values,
                                                          UIntPtr size);
  [DllImport(Library)]
  public static extern int sunder_simulation_destroyed(IntPtr simulation, byte[] values,
                                                       UIntPtr size);
  [DllImport(Library)]
  public static extern int sunder_simulation_event_count(IntPtr simulation, out int count);
  [DllImport(Library)]
  public static extern int sunder_simulation_event_at(IntPtr simulation, int index,
                                                      ref Rupture rupture);
  [DllImport(Library)]
  public static extern int sunder_simulation_interface_count(IntPtr simulation, out int count);
  [DllImport(Library)]
  public static extern int sunder_simulation_interface_at(IntPtr simulation, int index,
                                                          ref Interface state);
  [DllImport(Library)]
  public static extern int sunder_simulation_body(IntPtr simulation, ref NativeBody body);
  [DllImport(Library)]
  public static extern int sunder_simulation_body_nodes(IntPtr simulation, double[] values,
                                                        UIntPtr size);
  [DllImport(Library)]
  public static extern int sunder_simulation_body_corners(IntPtr simulation, int[] values,
                                                          UIntPtr size);
  [DllImport(Library)]
  public static extern int sunder_simulation_body_parents(IntPtr simulation, int[] values,
                                                          UIntPtr size);

  [DllImport(Library)]
  public static extern int sunder_simulation_step_within(IntPtr simulation, double maxMs,
                                                         ref Step step);
  [DllImport(Library)] public static extern int sunder_simulation_warm_up(IntPtr simulation);
  [DllImport(Library)]
  public static extern int sunder_simulation_remove(IntPtr simulation, int[] elements,
                                                    UIntPtr count);
  [DllImport(Library)]
  public static extern int sunder_simulation_cut(IntPtr simulation, double[] swept, UIntPtr size,
                                                 out int removed);
  [DllImport(Library)]
  public static extern int sunder_simulation_prepare(IntPtr simulation, int[] elements,
                                                     UIntPtr count);
  [DllImport(Library)]
  public static extern int sunder_simulation_prepare_near(IntPtr simulation, double[] near,
                                                          double radius, out int count);
  [DllImport(Library)]
  public static extern int sunder_simulation_grasp(IntPtr simulation, int[] nodes, UIntPtr count,
                                                   int rigid, out int grip);
  [DllImport(Library)]
  public static extern int sunder_simulation_grasp_near(IntPtr simulation, double[] near,
                                                        double radius, int rigid, out int grip);
  [DllImport(Library)]
  public static extern int sunder_simulation_held_nodes(IntPtr simulation, int grip, int[] nodes,
                                                        UIntPtr capacity, out UIntPtr count);
  [DllImport(Library)]
  public static extern int sunder_simulation_grip_place(IntPtr simulation, int grip,
                                                        double[] position);
  [DllImport(Library)]
  public static extern int sunder_simulation_pose(IntPtr simulation, int grip, double[] position,
                                                  double[] quaternion);
  [DllImport(Library)]
  public static extern int sunder_simulation_wrench(IntPtr simulation, int grip, double[] force,
                                                    double[] torque);
  [DllImport(Library)]
  public static extern int sunder_simulation_release(IntPtr simulation, int grip);
  [DllImport(Library)]
  public static extern int sunder_simulation_push(IntPtr simulation, int[] nodes, UIntPtr count,
                                                  double[] force, out int push);
  [DllImport(Library)]
  public static extern int sunder_simulation_move(IntPtr simulation, int push, int[] nodes,
                                                  UIntPtr count, double[] force);
  [DllImport(Library)] public static extern int sunder_simulation_drop(IntPtr simulation, int push);

  [DllImport(Library)]
  public static extern int sunder_simulation_keep_history(IntPtr simulation, int quick);
  [DllImport(Library)]
  public static extern int sunder_simulation_history(IntPtr simulation, out int undos,
                                                     out int redos);
  [DllImport(Library)]
  public static extern int sunder_simulation_undo(IntPtr simulation, int actions, out int events,
                                                  out int replayed);
  [DllImport(Library)]
  public static extern int sunder_simulation_redo(IntPtr simulation, int actions, out int events);
  [DllImport(Library)]
  public static extern int sunder_simulation_save(IntPtr simulation, out int mark);
  [DllImport(Library)]
  public static extern int sunder_simulation_restore(IntPtr simulation, int mark, out int replayed);
  [DllImport(Library)] public static extern int sunder_simulation_forget(IntPtr simulation, int mark);
  [DllImport(Library)]
  public static extern int sunder_simulation_store(IntPtr simulation, byte[] bytes, UIntPtr capacity,
                                                   out UIntPtr length);
  [DllImport(Library)]
  public static extern int sunder_simulation_load(IntPtr simulation, byte[] bytes, UIntPtr length);

  [DllImport(Library)]
  public static extern int sunder_simulation_surface(IntPtr simulation, ref NativeSurface surface);
  [DllImport(Library)]
  public static extern int sunder_simulation_surface_changes(IntPtr simulation, ulong since,
                                                             [Out] Triangle[] triangles,
                                                             UIntPtr capacity, out UIntPtr count);
  [DllImport(Library)]
  public static extern int sunder_simulation_surface_points(IntPtr simulation, float[] places,
                                                            float[] normals, UIntPtr size);
  [DllImport(Library)]
  public static extern int sunder_simulation_set_skin(IntPtr simulation, double[] vertices,
                                                      UIntPtr size);
  [DllImport(Library)]
  public static extern int sunder_simulation_skin(IntPtr simulation, float[] places, UIntPtr size,
                                                  byte[] lives);

  [DllImport(Library)]
  public static extern int sunder_grips_create(IntPtr simulation, out IntPtr grips);
  [DllImport(Library)] public static extern int sunder_grips_destroy(IntPtr grips);
  [DllImport(Library)]
  public static extern int sunder_grips_forces(IntPtr grips, double[] displacements,
                                               [In, Out] double[] forces, UIntPtr size);
  [DllImport(Library)] public static extern int sunder_grips_blend(IntPtr grips, double ms);
  [DllImport(Library)]
  public static extern int sunder_grips_feel(IntPtr grips, double[] displacements, double[] forces,
                                             UIntPtr size, [In, Out] Hand[] hands, UIntPtr count,
                                             ref Felt felt);
  [DllImport(Library)]
  public static extern int sunder_frames_create(IntPtr simulation, uint fields, int[] nodes,
                                                UIntPtr count, out IntPtr frames);
  [DllImport(Library)] public static extern int sunder_frames_destroy(IntPtr frames);
  [DllImport(Library)]
  public static extern int sunder_frames_take(IntPtr frames, ref NativeFrame frame);
  [DllImport(Library)]
  public static extern int sunder_frames_displacement(IntPtr frames, double[] values, UIntPtr size);
  [DllImport(Library)]
  public static extern int sunder_frames_stress(IntPtr frames, double[] values, UIntPtr size);
  [DllImport(Library)]
  public static extern int sunder_frames_yield_ratio(IntPtr frames, double[] values, UIntPtr size);
  [DllImport(Library)]
  public static extern int sunder_frames_destroyed(IntPtr frames, byte[] values, UIntPtr size);
}

}
