// A component that shows what a peer knows: one GameObject for each object, a prefab or a cube, moved each frame. Put it on an empty GameObject
// and give it the address that the peer prints.
using System.Collections.Generic;
using UnityEngine;

namespace Peerd
{
    public sealed class PeerdObjects : MonoBehaviour
    {
        public string address = "http://127.0.0.1:8080/";
        public GameObject prefab;
        [Range(1, 120)] public int hz = 30;

        readonly Dictionary<string, Transform> shown = new Dictionary<string, Transform>();
        PeerdClient peer;

        async void Start()
        {
            try
            {
                var connected = await PeerdClient.ConnectAsync(address);
                if (this == null) // the component was destroyed meanwhile
                {
                    connected.Dispose();
                    return;
                }
                peer = connected;
                await peer.WatchAsync(hz);
            }
            catch (System.Exception error)
            {
                Debug.LogError(error.Message, this);
            }
        }

        void Update()
        {
            if (peer == null) return;
            if (peer.Over != null)
            {
                Debug.LogError(peer.Over, this);
                enabled = false;
                return;
            }
            var known = new HashSet<string>(peer.Paths());
            foreach (var path in known)
            {
                Pose pose;
                if (peer.TryGetPose(path, out pose)) Place(TransformOf(path), pose);
            }
            foreach (var path in new List<string>(shown.Keys))
            {
                if (known.Contains(path)) continue;
                Destroy(shown[path].gameObject);
                shown.Remove(path);
            }
        }

        void OnDestroy()
        {
            if (peer != null) peer.Dispose();
        }

        Transform TransformOf(string path)
        {
            Transform found;
            if (shown.TryGetValue(path, out found)) return found;
            var made = prefab != null ? Instantiate(prefab) : GameObject.CreatePrimitive(PrimitiveType.Cube);
            made.name = path;
            made.transform.SetParent(transform, false);
            return shown[path] = made.transform;
        }

        // The world is right-handed and Unity left-handed, both with +Y up: z changes its sign, and so do rotations about x and y.
        static void Place(Transform at, Pose pose)
        {
            at.localPosition = new Vector3((float)pose.X, (float)pose.Y, (float)-pose.Z);
            at.localRotation = new Quaternion(-pose.Qx, -pose.Qy, pose.Qz, pose.Qw);
        }
    }
}
