// A client of a running peer's gateway (docs/reference/gateway.md) in plain .NET Standard 2.0: no type of Unity, no package. It authenticates,
// asks, edits, takes events, and keeps the newest poses by path. PeerdObjects.cs moves GameObjects by it.
using System;
using System.Collections.Concurrent;
using System.Collections.Generic;
using System.IO;
using System.Linq;
using System.Net.Http;
using System.Net.WebSockets;
using System.Runtime.Serialization.Json;
using System.Text;
using System.Threading;
using System.Threading.Tasks;
using System.Xml;
using System.Xml.Linq;

namespace Peerd
{
    /// Where an object is, in the world's frame: right-handed, +Y up, metres. The quaternion maps body to world.
    public struct Pose
    {
        public double X, Y, Z;
        public float Qx, Qy, Qz, Qw;
        public uint Owner; // a peer; 0: nobody
        public bool Own;   // the owner is the peer that this client talks to
    }

    /// What a request fails with: the peer's own sentence, or that the connection has ended.
    public sealed class PeerdException : Exception
    {
        public PeerdException(string sentence) : base(sentence) { }
    }

    /// Connects, and reads in a task of its own: any thread may call it. Replies and events are JSON as XML, as .NET's JSON reader gives it:
    /// reply.Element("peer").Element("name").Value.
    public sealed class PeerdClient : IDisposable
    {
        const double Patience_s = 10;

        readonly Uri page;
        readonly ClientWebSocket socket = new ClientWebSocket();
        readonly SemaphoreSlim sending = new SemaphoreSlim(1);
        readonly CancellationTokenSource ending = new CancellationTokenSource();
        readonly ConcurrentDictionary<long, TaskCompletionSource<XElement>> waiting = new ConcurrentDictionary<long, TaskCompletionSource<XElement>>();
        readonly object guard = new object(); // of what follows
        readonly Dictionary<string, Pose> poses = new Dictionary<string, Pose>();
        readonly List<byte[]> early = new List<byte[]>(); // frames of a scene that is still on its way
        string[] paths = new string[0];                   // of the nodes that rows of frames count; null: of no object
        long revision = -1;                               // of the scene whose nodes those are
        bool loading;
        string over;
        long lastSeq;

        /// Events as they come, for whoever reads them; AskAsync("subscribe", "to", ...) says which.
        public readonly ConcurrentQueue<XElement> Events = new ConcurrentQueue<XElement>();
        /// Session time of the newest frame [s].
        public double SessionTime_s { get; private set; }
        /// Why the connection has ended; null: it has not.
        public string Over { get { lock (guard) return over; } }

        PeerdClient(Uri address)
        {
            page = new Uri(address.GetLeftPart(UriPartial.Path));
        }

        /// To the address that the peer prints, http://HOST:PORT/#token=TOKEN. Without a token the client may look, and change nothing.
        public static async Task<PeerdClient> ConnectAsync(string address)
        {
            var printed = new Uri(address);
            var client = new PeerdClient(printed);
            var live = new UriBuilder(new Uri(client.page, "api/v1/live")) { Scheme = printed.Scheme == "https" ? "wss" : "ws" };
            await client.socket.ConnectAsync(live.Uri, client.ending.Token).ConfigureAwait(false);
            _ = Task.Run(client.ReadAsync);
            const string prefix = "#token=";
            if (printed.Fragment.StartsWith(prefix)) await client.AskAsync("token", "token", printed.Fragment.Substring(prefix.Length)).ConfigureAwait(false);
            return client;
        }

        /// A request and its members, by turns name and value: a string, bool, int, double, or an array of them. Throws a PeerdException where
        /// the peer has not done it.
        public async Task<XElement> AskAsync(string name, params object[] members)
        {
            var seq = Interlocked.Increment(ref lastSeq);
            var reply = new TaskCompletionSource<XElement>(TaskCreationOptions.RunContinuationsAsynchronously);
            waiting[seq] = reply;
            if (Over != null) Fail(seq, Over);
            else await SendAsync(Request(name, members, seq)).ConfigureAwait(false);
            var answer = await reply.Task.ConfigureAwait(false);
            var refused = answer.Element("refused");
            if (Text(answer, "ok") != "true") throw new PeerdException(name + ": " + Text(answer, "error"));
            if (Text(answer, "done") == "false") throw new PeerdException(name + ": " + (refused == null ? "not done" : refused.Value));
            return answer;
        }

        /// An edit ("grab", "add", "set", ...) until it is applied at the peer.
        public async Task EditAsync(string name, params object[] members)
        {
            var operation = (await AskAsync(name, members).ConfigureAwait(false)).Element("operation");
            var author = (long)operation.Element("author");
            var number = (long)operation.Element("number");
            for (var until = DateTime.UtcNow.AddSeconds(Patience_s); DateTime.UtcNow < until; await Task.Delay(50).ConfigureAwait(false))
            {
                var state = await AskAsync("operation", "author", author, "number", number).ConfigureAwait(false);
                if (Text(state, "applied") == "true") return;
            }
            throw new PeerdException(name + ": operation " + author + ":" + number + " is not applied yet");
        }

        /// Moves what is grabbed. The velocity is in m/s, the time is now.
        public Task PoseAsync(string path, double[] position_m, double[] orientation_xyzw, double[] velocity_m_s)
        {
            var now_s = (DateTime.UtcNow - new DateTime(1970, 1, 1, 0, 0, 0, DateTimeKind.Utc)).TotalSeconds;
            return AskAsync("pose", "object", path, "position_m", position_m, "orientation_xyzw", orientation_xyzw, "velocity_m_s", velocity_m_s, "time_s", now_s);
        }

        /// Frames of poses from now on, so many a second (1 to 120).
        public Task WatchAsync(int hz)
        {
            return AskAsync("watch", "hz", hz);
        }

        /// The newest pose; false: none is known.
        public bool TryGetPose(string path, out Pose pose)
        {
            lock (guard) return poses.TryGetValue(path, out pose);
        }

        /// All objects whose pose is known.
        public string[] Paths()
        {
            lock (guard) return poses.Keys.ToArray();
        }

        public void Dispose()
        {
            End("the connection was closed by this program");
            ending.Cancel();
            socket.Dispose();
        }

        // ------------------------------------------------------------------------------------------------------------ the socket

        async Task SendAsync(string text)
        {
            await sending.WaitAsync().ConfigureAwait(false); // a WebSocket sends one message at a time
            try
            {
                var bytes = new ArraySegment<byte>(Encoding.UTF8.GetBytes(text));
                await socket.SendAsync(bytes, WebSocketMessageType.Text, true, ending.Token).ConfigureAwait(false);
            }
            catch (Exception error)
            {
                End("the connection to the peer has ended: " + error.Message);
            }
            finally
            {
                sending.Release();
            }
        }

        async Task ReadAsync()
        {
            try
            {
                var part = new byte[1 << 16];
                while (true)
                {
                    var message = new MemoryStream();
                    WebSocketReceiveResult got;
                    do
                    {
                        got = await socket.ReceiveAsync(new ArraySegment<byte>(part), ending.Token).ConfigureAwait(false);
                        message.Write(part, 0, got.Count);
                    } while (!got.EndOfMessage);
                    if (got.MessageType == WebSocketMessageType.Close) throw new PeerdException("the peer has closed it");
                    if (got.MessageType == WebSocketMessageType.Text) TakeText(message.ToArray());
                    else TakeFrame(message.ToArray());
                }
            }
            catch (Exception error)
            {
                End("the connection to the peer has ended: " + error.Message);
            }
        }

        void TakeText(byte[] text)
        {
            var message = Json(text);
            if (message.Element("event") != null)
            {
                Events.Enqueue(message);
                return;
            }
            if (message.Element("seq") == null) throw new PeerdException(Text(message, "error"));
            TaskCompletionSource<XElement> reply;
            if (waiting.TryRemove((long)message.Element("seq"), out reply)) reply.TrySetResult(message);
        }

        void End(string why)
        {
            lock (guard)
            {
                if (over != null) return;
                over = why;
            }
            foreach (var seq in waiting.Keys) Fail(seq, why);
        }

        void Fail(long seq, string why)
        {
            TaskCompletionSource<XElement> reply;
            if (waiting.TryRemove(seq, out reply)) reply.TrySetException(new PeerdException(why));
        }

        // ---------------------------------------------------------------------------------------------------------------- frames

        // 0 u32 "PDF1"  4 u32 rows  8 f64 session time [s]  32 u32 revision  36 u32 bytes of a row  40 rows:
        //   0 u32 node  4 u32 owner  8 u16 kind  10 u16 flags  16 f64 x y z [m]  40 f32 qx qy qz qw. All little endian.
        void TakeFrame(byte[] frame)
        {
            if (frame.Length < 40 || BitConverter.ToUInt32(frame, 0) != 0x31464450) throw new PeerdException("a binary message is not a pose frame");
            lock (guard)
            {
                var of = BitConverter.ToUInt32(frame, 32);
                if (of < revision) return; // the scene is newer already, and a frame with all of it comes
                if (of == revision)
                {
                    ReadRows(frame);
                    return;
                }
                early.Add(frame);
                if (loading) return;
                loading = true;
            }
            _ = Task.Run(LoadSceneAsync);
        }

        void ReadRows(byte[] frame)
        {
            var rows = BitConverter.ToUInt32(frame, 4);
            var rowBytes = (int)BitConverter.ToUInt32(frame, 36);
            if (rowBytes < 56 || frame.Length < 40 + rows * (long)rowBytes) throw new PeerdException("a pose frame is cut off");
            SessionTime_s = BitConverter.ToDouble(frame, 8);
            for (var at = 40; rows > 0; --rows, at += rowBytes)
            {
                var node = BitConverter.ToUInt32(frame, at);
                if (node >= paths.Length || paths[node] == null || BitConverter.ToUInt16(frame, at + 8) != 0) continue; // 0: shown
                poses[paths[node]] = new Pose
                {
                    X = BitConverter.ToDouble(frame, at + 16),
                    Y = BitConverter.ToDouble(frame, at + 24),
                    Z = BitConverter.ToDouble(frame, at + 32),
                    Qx = BitConverter.ToSingle(frame, at + 40),
                    Qy = BitConverter.ToSingle(frame, at + 44),
                    Qz = BitConverter.ToSingle(frame, at + 48),
                    Qw = BitConverter.ToSingle(frame, at + 52),
                    Owner = BitConverter.ToUInt32(frame, at + 4),
                    Own = (BitConverter.ToUInt16(frame, at + 10) & 1) != 0,
                };
            }
        }

        // Rows count the nodes of the scene, a glTF binary: 12 u32 length of its JSON, 20 the JSON.
        async Task LoadSceneAsync()
        {
            try
            {
                using (var http = new HttpClient())
                {
                    for (var more = true; more;)
                    {
                        var file = await http.GetByteArrayAsync(new Uri(page, "api/v1/scene.glb")).ConfigureAwait(false);
                        more = TakeScene(Json(file.Skip(20).Take(BitConverter.ToInt32(file, 12)).ToArray()));
                    }
                }
            }
            catch (Exception error)
            {
                End("the scene could not be read: " + error.Message);
                ending.Cancel();
            }
        }

        // Whether frames of a newer scene wait.
        bool TakeScene(XElement gltf)
        {
            lock (guard)
            {
                revision = (long)gltf.Element("asset").Element("extras").Element("revision");
                paths = gltf.Element("nodes").Elements().Select(node => node.Element("extras")).Select(PathOf).ToArray();
                poses.Clear();
                foreach (var frame in early.Where(frame => BitConverter.ToUInt32(frame, 32) == revision)) ReadRows(frame);
                early.RemoveAll(frame => BitConverter.ToUInt32(frame, 32) <= revision);
                loading = early.Count > 0;
                return loading;
            }
        }

        static string PathOf(XElement extras)
        {
            return extras == null || extras.Element("id") == null ? null : Text(extras, "path");
        }

        // ------------------------------------------------------------------------------------------------------------------ JSON

        static XElement Json(byte[] text)
        {
            using (var reader = JsonReaderWriterFactory.CreateJsonReader(text, XmlDictionaryReaderQuotas.Max)) return XElement.Load(reader);
        }

        static string Text(XElement of, string name)
        {
            var member = of.Element(name);
            return member == null ? null : member.Value;
        }

        static string Request(string name, object[] members, long seq)
        {
            var request = new XElement("root", new XAttribute("type", "object"), Member("do", name), Member("seq", seq));
            for (var i = 0; i + 1 < members.Length; i += 2) request.Add(Member((string)members[i], members[i + 1]));
            var text = new MemoryStream();
            using (var writer = JsonReaderWriterFactory.CreateJsonWriter(text, Encoding.UTF8)) request.Save(writer);
            return Encoding.UTF8.GetString(text.ToArray());
        }

        static XElement Member(string name, object value)
        {
            var list = value as Array;
            if (list != null) return new XElement(name, new XAttribute("type", "array"), list.Cast<object>().Select(item => Member("item", item)));
            var type = value is string ? "string" : value is bool ? "boolean" : "number";
            return new XElement(name, new XAttribute("type", type), value);
        }
    }
}
