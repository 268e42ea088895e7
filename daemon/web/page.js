/* page.js - keeps a page that is open up to date, and shows radiance
 *
 * The server sends the page's sections as HTML that it has made safe.  The page
 * is changed where they differ from it and nowhere else, so the focus, what is
 * marked, and how far a table is scrolled stay.  The section of the picture is
 * left alone: its radiance is fetched again where there is more of it, and drawn
 * with the exposure or the false colours that were chosen here. */
"use strict";

/* --- the picture --- */

const HEAD = 16;      /* bytes ahead of the pixels, see picture.h */
const EFFICACY = 179; /* lm/W */
const SCALES = [
    [ 68, 1, 84 ],
    [ 59, 82, 139 ],
    [ 33, 145, 140 ],
    [ 94, 201, 98 ],
    [ 253, 231, 37 ],
];

const gamma = new Uint8ClampedArray(4097);
for (let i = 0; i <= 4096; i++) {
    const v = i / 4096;
    gamma[i] =
        255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055);
}
const power = new Float64Array(256);
for (let e = 1; e < 256; e++)
    power[e] = 2 ** (e - 136);

function palette(v)
{
    const t = Math.min(Math.max(v, 0), 1) * (SCALES.length - 1);
    const i = Math.min(Math.floor(t), SCALES.length - 2), f = t - i;
    return SCALES[i].map((a, k) => a + f * (SCALES[i + 1][k] - a));
}

class Viewer
{
    constructor(section, image)
    {
        this.section = section;
        this.stops = 0;
        this.mode = "tone";
        this.canvas = document.createElement("canvas");
        this.canvas.className = "view";
        this.canvas.hidden = true;
        this.canvas.tabIndex = 0;
        this.canvas.setAttribute("role", "img");
        this.canvas.setAttribute("aria-label", image.alt);
        this.canvas.setAttribute("aria-describedby", "probe");
        image.after(this.canvas);
        this.image = image;
        this.addTools();
        this.load();
    }

    addTools()
    {
        const box = document.createElement("div");
        box.className = "tools";
        const exposure = document.createElement("label");
        exposure.append("Exposure ");
        this.slider = document.createElement("input");
        Object.assign(this.slider, {
            type : "range",
            min : -8,
            max : 8,
            step : 0.25,
            value : 0,
            id : "exposure",
        });
        this.said = document.createElement("output");
        exposure.append(this.slider, " ", this.said);
        this.choice = document.createElement("select");
        this.choice.id = "mode";
        this.choice.setAttribute("aria-label", "Show as");
        for (const [value, text] of [[ "tone", "Picture" ],
                                     [ "log", "False colour, 3 decades" ],
                                     [ "linear", "False colour" ]])
            this.choice.append(new Option(text, value));
        this.legend = document.createElement("span");
        this.legend.hidden = true;
        this.bar = document.createElement("canvas");
        this.bar.className = "legend";
        this.bar.width = 200;
        this.bar.height = 1;
        this.low = document.createElement("span");
        this.high = document.createElement("span");
        this.legend.append(this.low, " ", this.bar, " ", this.high);
        box.append(this.choice, exposure, this.legend);
        this.probe = document.createElement("p");
        this.probe.className = "probe";
        this.probe.id = "probe";
        this.probe.textContent = "Point at the picture for its luminance, " +
                                 "or go there with Tab and the arrow keys.";
        this.canvas.after(box);
        box.after(this.probe);
        this.slider.addEventListener("input", () => this.draw());
        this.choice.addEventListener("change", () => this.draw());
        this.canvas.addEventListener("pointermove", e => this.point(e));
        this.canvas.addEventListener("pointerdown", e => this.point(e));
        this.canvas.addEventListener("keydown", e => this.step(e));
    }

    async load()
    {
        if (this.busy) {
            this.again = true;
            return;
        }
        const begin = performance.now();
        this.busy = true;
        this.again = false;
        try {
            const address = new URL(this.section.dataset.raw, document.baseURI);
            address.username = address.password = ""; /* fetch refuses these */
            const answer = await fetch(address, {
                signal : AbortSignal.timeout(60000),
            });
            if (answer.ok)
                this.take(await answer.arrayBuffer());
        } catch (e) {
            /* the next version is tried again */
        }
        /* a slow line is left to others for most of the time */
        setTimeout(() => {
            this.busy = false;
            if (this.again)
                this.load();
        }, 4 * (performance.now() - begin));
    }

    take(buffer)
    {
        const view = new DataView(buffer);
        if (buffer.byteLength < HEAD || view.getUint32(0) !== 0x52575031)
            return;
        this.width = view.getUint32(4);
        this.height = view.getUint32(8);
        this.factor = view.getUint32(12);
        this.rgbe = new Uint8Array(buffer, HEAD);
        if (this.rgbe.length !== 4 * this.width * this.height)
            return;
        this.measure();
        this.canvas.width = this.width;
        this.canvas.height = this.height;
        this.draw();
        this.canvas.hidden = false;
        this.image.hidden = true;
        if (this.at)
            this.tell(this.at.x, this.at.y);
    }

    pixel(i)
    {
        const p = this.rgbe, f = power[p[4 * i + 3]];
        return f === 0 ? [ 0, 0, 0 ] : [
            (p[4 * i] + 0.5) * f, (p[4 * i + 1] + 0.5) * f,
            (p[4 * i + 2] + 0.5) * f
        ];
    }

    /* The log-average and the brightest hundredth, of what is not black. */
    measure()
    {
        const n = this.width * this.height, step = Math.max(1, n >> 16);
        const logs = [];
        for (let i = 0; i < n; i += step) {
            const L = luminance(this.pixel(i));
            if (L > 0)
                logs.push(Math.log(L));
        }
        logs.sort((a, b) => a - b);
        const at = q =>
            logs.length ? Math.exp(logs[Math.floor(q * (logs.length - 1))]) : 1;
        this.mean =
            logs.length
                ? Math.exp(logs.reduce((a, b) => a + b, 0) / logs.length)
                : 1;
        this.white = at(0.99);
        const top = at(0.999), decade = 10 ** Math.floor(Math.log10(top));
        this.top = [ 1, 2, 5, 10 ].map(k => k * decade).find(v => v >= top);
    }

    draw()
    {
        if (!this.rgbe)
            return;
        const stops = Number(this.slider.value);
        const said = (stops > 0 ? "+" : "") + stops + " stops";
        if (this.said.textContent !== said)
            this.said.textContent = said;
        this.slider.setAttribute("aria-valuetext", said);
        const data = new ImageData(this.width, this.height);
        if (this.choice.value === "tone")
            this.fillTone(data.data, 2 ** stops * 0.18 / this.mean);
        else
            this.fillFalse(data.data, this.top / 2 ** stops,
                           this.choice.value === "log");
        this.canvas.getContext("2d").putImageData(data, 0, 0);
        if (this.keyed)
            this.drawCross();
        this.drawLegend(this.top / 2 ** stops);
    }

    /* Where the keys have gone: white on black, to be seen on any picture. */
    drawCross()
    {
        const c = this.canvas.getContext("2d"), { x, y } = this.at;
        const unit = this.width / this.canvas.clientWidth;
        for (const [colour, wide] of [[ "#000", 4 ], [ "#fff", 2 ]]) {
            c.strokeStyle = colour;
            c.lineWidth = wide * unit;
            c.beginPath();
            c.arc(x + 0.5, y + 0.5, 8 * unit, 0, 2 * Math.PI);
            c.stroke();
        }
    }

    /* Reinhard et al. 2002, equation 4, on luminance. */
    fillTone(out, scale)
    {
        const p = this.rgbe, white = Math.max(this.white * scale, 1);
        for (let i = 0; i < out.length; i += 4) {
            const f = power[p[i + 3]];
            out[i + 3] = 255;
            if (f === 0)
                continue;
            const r = (p[i] + 0.5) * f, g = (p[i + 1] + 0.5) * f,
                  b = (p[i + 2] + 0.5) * f;
            const X =
                EFFICACY * (0.265074 * r + 0.670115 * g + 0.064811 * b) * scale;
            const k = EFFICACY * scale * (1 + X / (white * white)) / (1 + X);
            out[i] = gamma[Math.min(4096, r * k * 4096) | 0];
            out[i + 1] = gamma[Math.min(4096, g * k * 4096) | 0];
            out[i + 2] = gamma[Math.min(4096, b * k * 4096) | 0];
        }
    }

    fillFalse(out, top, log)
    {
        const table = [];
        for (let i = 0; i < 256; i++)
            table.push(palette(i / 255));
        for (let i = 0, k = 0; i < out.length; i += 4, k++) {
            const v = luminance(this.pixel(k)) / top;
            out[i + 3] = 255;
            if (v <= 0)
                continue;
            const at = log ? Math.log10(v) / 3 + 1 : v;
            const c = table[Math.round(255 * Math.min(Math.max(at, 0), 1))];
            out[i] = c[0];
            out[i + 1] = c[1];
            out[i + 2] = c[2];
        }
    }

    drawLegend(top)
    {
        this.legend.hidden = this.choice.value === "tone";
        if (this.legend.hidden)
            return;
        const c = this.bar.getContext("2d"), line = c.createImageData(200, 1);
        for (let i = 0; i < 200; i++)
            line.data.set([...palette(i / 199), 255 ], 4 * i);
        c.putImageData(line, 0, 0);
        this.low.textContent =
            this.choice.value === "log" ? number(top / 1000) : "0";
        this.high.textContent = number(top) + " cd/m²";
    }

    point(e)
    {
        const box = this.canvas.getBoundingClientRect();
        const x = Math.floor((e.clientX - box.left) / box.width * this.width);
        const y = Math.floor((e.clientY - box.top) / box.height * this.height);
        if (this.rgbe && x >= 0 && y >= 0 && x < this.width &&
            y < this.height) {
            const keyed = this.keyed;
            this.keyed = false;
            this.probe.ariaLive = "off"; /* a pointer passes many pixels */
            this.tell(x, y);
            if (keyed)
                this.draw();
        }
    }

    /* Go by a key: a pixel, with Shift a tenth of the picture. */
    step(e)
    {
        const way = {
            ArrowLeft : [ -1, 0 ],
            ArrowRight : [ 1, 0 ],
            ArrowUp : [ 0, -1 ],
            ArrowDown : [ 0, 1 ],
        }[e.key];
        if (!way || !this.rgbe || e.altKey || e.ctrlKey || e.metaKey)
            return;
        e.preventDefault();
        const far = e.shiftKey ? Math.ceil(this.width / 10) : 1;
        const at = this.at || { x : this.width >> 1, y : this.height >> 1 };
        this.keyed = true;
        this.probe.ariaLive = "polite";
        this.tell(Math.min(Math.max(at.x + far * way[0], 0), this.width - 1),
                  Math.min(Math.max(at.y + far * way[1], 0), this.height - 1));
        this.draw();
    }

    tell(x, y)
    {
        const [r, g, b] = this.pixel(y * this.width + x);
        const X = 0.514145 * r + 0.323884 * g + 0.161971 * b;
        const Y = 0.265106 * r + 0.670106 * g + 0.064788 * b;
        const Z = 0.024101 * r + 0.122853 * g + 0.853047 * b;
        const sum = X + Y + Z;
        const value = document.createElement("b");
        this.at = { x, y };
        value.textContent = number(luminance([ r, g, b ])) + " cd/m²";
        this.probe.replaceChildren(
            `x ${x * this.factor} y ${y * this.factor}: `, value,
            `, radiance ${number(r)} ${number(g)} ${number(b)} W/sr/m²` +
                (sum > 0 ? `, chromaticity ${(X / sum).toFixed(3)} ` +
                               `${(Y / sum).toFixed(3)}`
                         : ""));
    }
}

function luminance([ r, g, b ])
{
    return EFFICACY * (0.265074 * r + 0.670115 * g + 0.064811 * b);
}

function number(v)
{
    return v === 0                ? "0"
           : v >= 1e6 || v < 1e-3 ? v.toExponential(2)
                                  : String(+v.toPrecision(3));
}

/* --- sections --- */

let viewer = null;

function look(section)
{
    const image = section.querySelector("#shown");
    viewer = image ? new Viewer(section, image) : null;
}

function addCopy()
{
    const words = document.getElementById("words");
    if (!words || !navigator.clipboard ||
        words.parentNode.querySelector("button"))
        return;
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = "Copy";
    button.addEventListener("click", async () => {
        await navigator.clipboard.writeText(words.textContent);
        button.textContent = "Copied";
    });
    words.after(button);
}

const keyOf = node => node.dataset && node.dataset.key;

/* Make the children of an element like those of another.  Rows go by their keys;
 * all else goes by its place. */
function mergeChildren(old, now)
{
    const rows = new Map(Array.from(old.children, c => [keyOf(c), c]));
    let at = old.firstChild;
    for (const next of Array.from(now.childNodes)) {
        const key = keyOf(next);
        const had = key ? rows.get(key) : at && !keyOf(at) ? at : null;
        if (!had || had.nodeName !== next.nodeName) {
            old.insertBefore(next, at);
            continue;
        }
        if (had === at)
            at = at.nextSibling;
        else
            old.insertBefore(had, at);
        merge(had, next);
    }
    while (at) {
        const gone = at;
        at = at.nextSibling;
        gone.remove();
    }
}

/* Make a node like another of the same name. */
function merge(old, now)
{
    if (old.isEqualNode(now))
        return;
    if (old.nodeType !== Node.ELEMENT_NODE) {
        old.nodeValue = now.nodeValue;
        return;
    }
    for (const a of Array.from(old.attributes))
        if (!now.hasAttribute(a.name))
            old.removeAttribute(a.name);
    for (const a of now.attributes)
        if (old.getAttribute(a.name) !== a.value)
            old.setAttribute(a.name, a.value);
    mergeChildren(old, now);
}

function put(section)
{
    const old = document.getElementById(section.id);
    if (!old) {
        document.querySelector("main").append(section);
        return;
    }
    if (section.id === "picture" && viewer) {
        if (old.dataset.version !== section.dataset.version) {
            old.dataset.version = section.dataset.version;
            viewer.load();
        }
        return;
    }
    if (section.id === "command" && old.querySelector("#words") &&
        section.querySelector("#words") &&
        old.querySelector("#words").textContent ===
            section.querySelector("#words").textContent)
        return; /* with its button */
    merge(old, section);
    if (section.id === "picture")
        look(old);
    if (section.id === "command")
        addCopy();
}

function take(html)
{
    const page = new DOMParser().parseFromString(html, "text/html");
    const focus = document.activeElement;
    for (const section of page.querySelectorAll("section[id]"))
        put(section);
    if (focus !== document.activeElement) /* its row was moved */
        focus.focus({preventScroll : true});
}

/* --- the stream of events --- */

const SILENT_MS = 40000; /* the server says something each 15 s */

let stream = null, timer = 0;

function tell(text, on)
{
    const live = document.getElementById("live");
    if (live.textContent !== text) /* a screen reader reads what is set */
        live.textContent = text;
    live.className = on ? "on" : "";
}

function unfollow()
{
    clearTimeout(timer);
    if (stream)
        stream.close();
    stream = null;
}

/* Dial again if nothing is heard for so long: a line can be dead, as after a
 * laptop's sleep, without either end knowing. */
function wait(ms)
{
    clearTimeout(timer);
    timer = setTimeout(() => {
        tell("not connected", false);
        follow();
    }, ms);
}

/* Of a job that is gone nothing more comes. */
function end()
{
    document.removeEventListener("visibilitychange", follow);
    unfollow();
    tell("not live", false);
}

/* A page that is not seen has no stream: browsers open but six connections to a
 * server, and pages in further tabs would wait for one of them for good. */
function follow()
{
    unfollow();
    if (document.hidden)
        return;
    stream = new EventSource(document.body.dataset.events);
    stream.addEventListener("sign", () => wait(SILENT_MS));
    stream.onmessage = e => {
        take(e.data);
        if (document.querySelector("#trouble.gone")) {
            end();
            return;
        }
        const away = document.querySelector("#trouble.away");
        tell(away ? "not live" : "live", !away);
        wait(SILENT_MS);
    };
    stream.onerror = () => {
        tell("not connected", false);
        /* a browser dials again by itself, but not after an answer that is none
         */
        wait(stream.readyState === EventSource.CLOSED ? 10000 : SILENT_MS);
    };
    wait(SILENT_MS);
}

const picture = document.getElementById("picture");
if (picture)
    look(picture);
addCopy();
if (document.body.dataset.events) {
    document.addEventListener("visibilitychange", follow);
    follow();
}
