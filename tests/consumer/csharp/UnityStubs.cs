// SPDX-License-Identifier: Apache-2.0
// The types of Unity that SunderBody.cs uses, as far as it uses them: enough to compile it and to run
// its messages by hand. They are this project's own; Unity itself is not needed and not tested.
using System;
using System.Collections.Generic;
using System.Reflection;

namespace UnityEngine {

public struct Vector3 {
  public float x, y, z;
  public Vector3(float x, float y, float z) {
    this.x = x;
    this.y = y;
    this.z = z;
  }
}

public struct Quaternion {
  public float x, y, z, w;
  public Quaternion(float x, float y, float z, float w) {
    this.x = x;
    this.y = y;
    this.z = z;
    this.w = w;
  }
}

[AttributeUsage(AttributeTargets.Class)]
public class RequireComponent : Attribute {
  public RequireComponent(Type type) {}
}

public class Mesh {
  public Vector3[] vertices, normals;
  public int[] triangles;
}

public class MeshFilter {
  public Mesh mesh;
}

public static class Debug {
  public static readonly List<string> Warnings = new List<string>();
  public static void LogWarning(object message) { Warnings.Add(message.ToString()); }
}

public class MonoBehaviour {
  readonly Dictionary<Type, object> components = new Dictionary<Type, object>();

  public T GetComponent<T>() where T : new() {
    if (!components.ContainsKey(typeof(T))) components[typeof(T)] = new T();
    return (T)components[typeof(T)];
  }
  /// <summary>What Unity does: Start, FixedUpdate and so on, by name.</summary>
  public void Send(string message) {
    GetType().GetMethod(message, BindingFlags.Instance | BindingFlags.NonPublic)
        .Invoke(this, null);
  }
}

}
