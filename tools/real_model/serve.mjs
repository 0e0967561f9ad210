// Serve a GGUF model by OpenAI's protocol of chat completions, on this machine only.
//
//     node serve.mjs MODEL.gguf [PORT]
//
// Answers are streamed. A request whose client goes away is aborted; requests are answered one by one.
import http from "node:http";
import {getLlama, LlamaChatSession} from "node-llama-cpp";

const [file, port = "8000"] = process.argv.slice(2);
const llama = await getLlama({gpu: false, logLevel: "error"});
const model = await llama.loadModel({modelPath: file});
const context = await model.createContext({contextSize: {max: 8192}, threads: Number(process.env.THREADS ?? 1)});
const sequence = context.getSequence();
const ENDS = {maxTokens: "length"};
let turn = Promise.resolve();

/** Read the body of a request as JSON. */
async function body(request) {
    let text = "";
    for await (const piece of request) text += piece;
    return JSON.parse(text);
}

/** Split a conversation into a history and the last prompt, as a chat session takes them. */
function conversation(messages) {
    const history = messages.slice(0, -1).map(({role, content}) => {
        if (role === "system") return {type: "system", text: content};
        return role === "user" ? {type: "user", text: content} : {type: "model", response: [content]};
    });
    return [history, messages.at(-1).content];
}

/** Answer one request as a stream of events. */
async function answer({messages, temperature, seed, max_tokens, max_completion_tokens}, response) {
    const gone = new AbortController();
    response.on("close", () => gone.abort());
    if (response.destroyed) return;
    const send = (choice, more = {}) => response.write(`data: ${JSON.stringify({
        id: "chat", object: "chat.completion.chunk", created: 0, model: "local", choices: choice ? [{index: 0, ...choice}] : [], ...more
    })}\n\n`);
    await sequence.clearHistory();
    const session = new LlamaChatSession({contextSequence: sequence, autoDisposeSequence: false});
    const [history, prompt] = conversation(messages);
    session.setChatHistory(history);
    const before = sequence.tokenMeter.getState();
    response.writeHead(200, {"content-type": "text/event-stream"});
    send({delta: {role: "assistant", content: ""}, finish_reason: null});
    try {
        const {stopReason} = await session.promptWithMeta(prompt, {
            temperature, seed, maxTokens: max_completion_tokens ?? max_tokens, signal: gone.signal,
            onTextChunk: (content) => send({delta: {content}, finish_reason: null})
        });
        const used = sequence.tokenMeter.diff(before);
        send({delta: {}, finish_reason: ENDS[stopReason] ?? "stop"});
        send(null, {usage: {prompt_tokens: used.usedInputTokens, completion_tokens: used.usedOutputTokens,
            total_tokens: used.usedInputTokens + used.usedOutputTokens}});
        response.end("data: [DONE]\n\n");
    } catch (error) {
        if (gone.signal.aborted) return;
        response.end(`data: ${JSON.stringify({error: {message: String(error), type: "server_error"}})}\n\n`);
    } finally {
        session.dispose();
    }
}

const server = http.createServer(async (request, response) => {
    const asked = await body(request);
    turn = turn.then(() => answer(asked, response)).catch((error) => response.destroy(error));
});
server.listen(Number(port), "127.0.0.1", () => console.log(`http://127.0.0.1:${server.address().port}/v1`));
