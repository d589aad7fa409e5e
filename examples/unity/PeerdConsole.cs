// peerd_console ADDRESS [OBJECT]: prints where everything is; with OBJECT it takes that object, lifts it by a metre in a second, and lets it go.
//
//   mcs -out:peerd_console.exe -r:System.Net.Http -r:System.Runtime.Serialization -r:System.Xml.Linq PeerdClient.cs PeerdConsole.cs
using System;
using System.Threading.Tasks;
using Peerd;

static class PeerdConsole
{
    static int Main(string[] words)
    {
        try
        {
            RunAsync(words[0], words.Length > 1 ? words[1] : null).GetAwaiter().GetResult();
            return 0;
        }
        catch (PeerdException error)
        {
            Console.Error.WriteLine(error.Message);
            return 1;
        }
    }

    static async Task RunAsync(string address, string path)
    {
        using (var peer = await PeerdClient.ConnectAsync(address))
        {
            await peer.WatchAsync(30);
            while (peer.Paths().Length == 0) await PauseAsync(peer);
            Print(peer);
            if (path == null) return;
            await peer.AskAsync("subscribe", "to", new[] { "objects" });
            await peer.EditAsync("grab", "path", path);
            Pose from, now;
            if (!peer.TryGetPose(path, out from)) throw new PeerdException("nothing is known of " + path);
            var orientation = new double[] { from.Qx, from.Qy, from.Qz, from.Qw };
            for (var i = 0; i <= 60; ++i)
            {
                await peer.PoseAsync(path, new[] { from.X, from.Y + i / 60.0, from.Z }, orientation, new[] { 0.0, 1.0, 0.0 });
                await Task.Delay(16);
            }
            await peer.PoseAsync(path, new[] { from.X, from.Y + 1, from.Z }, orientation, new[] { 0.0, 0.0, 0.0 });
            do
            {
                await PauseAsync(peer);
                peer.TryGetPose(path, out now);
            } while (now.Y < from.Y + 0.9);
            await peer.AskAsync("let_go", "path", path);
            System.Xml.Linq.XElement change;
            while (peer.Events.TryDequeue(out change)) Console.WriteLine("{0} {1}", change.Element("event").Value, change.Element("object").Value);
            Print(peer);
        }
    }

    static async Task PauseAsync(PeerdClient peer)
    {
        if (peer.Over != null) throw new PeerdException(peer.Over);
        await Task.Delay(10);
    }

    static void Print(PeerdClient peer)
    {
        foreach (var path in peer.Paths())
        {
            Pose pose;
            if (peer.TryGetPose(path, out pose)) Console.WriteLine("{0} {1:F2} {2:F2} {3:F2} of peer {4}", path, pose.X, pose.Y, pose.Z, pose.Owner);
        }
    }
}
